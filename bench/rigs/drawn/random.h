// Random numbers of one stream, the same on every machine: a counter through the SplitMix64 mixer.
#pragma once

#include <cmath>
#include <cstdint>

namespace sinew::rigs {

class Random {
 public:
  // Streams of one seed are independent of one another.
  Random(std::uint64_t seed, std::uint64_t stream)
      : state_(Mix(Mix(seed) + 0x632be59bd9b4e019ULL * (stream + 1))) {}

  std::uint64_t Next() { return Mix(state_ += 0x9e3779b97f4a7c15ULL); }
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1.0p-53; }  // in [0, 1)
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  double LogUniform(double low, double high) { return low * std::pow(high / low, Uniform()); }
  int Integer(int low, int high) {  // both included
    return low + static_cast<int>(Next() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool Chance(double p) { return Uniform() < p; }
  double Sign() { return Chance(0.5) ? 1.0 : -1.0; }
  double Normal() {  // Box-Muller, one of the pair
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(2.0 * 3.14159265358979323846 * Uniform());
  }

 private:
  static std::uint64_t Mix(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }
  std::uint64_t state_;
};

}  // namespace sinew::rigs

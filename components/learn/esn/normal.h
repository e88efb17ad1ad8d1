// Normally distributed numbers that depend on the seed alone.
//
// The bits are those of std::mt19937_64, which the standard fixes; the transform (Box and Muller
// 1958) is ours, because the standard leaves std::normal_distribution to the library. What remains
// of the platform is the last bit of log, sin and cos of its C library.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

namespace sinew::esn {

class NormalGenerator {
 public:
  explicit NormalGenerator(std::uint64_t seed) : bits_(seed) {}

  // Mean 0, standard deviation 1.
  double Next() {
    if (has_spare_) {
      has_spare_ = false;
      return spare_;
    }
    const double radius = std::sqrt(-2.0 * std::log(Uniform()));
    const double angle = 2.0 * std::numbers::pi * Uniform();
    spare_ = radius * std::sin(angle);
    has_spare_ = true;
    return radius * std::cos(angle);
  }

  // Uniform in 0 .. count - 1; the bias of at most count / 2^64 does not matter here.
  int Below(int count) { return static_cast<int>(bits_() % static_cast<std::uint64_t>(count)); }

 private:
  // In (0, 1).
  double Uniform() { return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1p-53; }

  std::mt19937_64 bits_;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace sinew::esn

// Random numbers of the surrogate: one counter-based stream per sensor.
//
// Value number n of stream s is SplitMix64(key(seed, s) + n): adding a sensor or reading one more
// often does not change what another one draws, and the same seed gives the same bits everywhere.
// Source of the mixing function: Steele, Lea, Flood, "Fast splittable pseudorandom number
// generators", OOPSLA 2014. Not for cryptography. One owner per stream; no allocation, no clock.
#pragma once

#include <cstdint>

namespace sinew::surrogate {

class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t stream) noexcept;

  std::uint64_t Bits() noexcept;
  double Uniform() noexcept;                            // in (0, 1)
  double Uniform(double lower, double upper) noexcept;  // in (lower, upper)
  double Gaussian() noexcept;                           // mean 0, standard deviation 1 (Box-Muller)

 private:
  std::uint64_t key_;
  std::uint64_t counter_ = 0;
  double spare_ = 0.0;
  bool has_spare_ = false;
};

}  // namespace sinew::surrogate

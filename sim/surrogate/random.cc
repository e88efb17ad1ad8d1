#include "sim/surrogate/random.h"

#include <cmath>
#include <numbers>

namespace sinew::surrogate {
namespace {

std::uint64_t Mix(std::uint64_t value) noexcept {
  value = (value ^ (value >> 30)) * 0xBF58476D1CE4E5B9ULL;
  value = (value ^ (value >> 27)) * 0x94D049BB133111EBULL;
  return value ^ (value >> 31);
}

constexpr std::uint64_t kGoldenGamma = 0x9E3779B97F4A7C15ULL;

}  // namespace

RandomStream::RandomStream(std::uint64_t seed, std::uint64_t stream) noexcept
    : key_(Mix(Mix(seed + kGoldenGamma) ^ (stream + 1) * 0xD1B54A32D192ED03ULL)) {}

std::uint64_t RandomStream::Bits() noexcept { return Mix(key_ + kGoldenGamma * ++counter_); }

double RandomStream::Uniform() noexcept {
  return (static_cast<double>(Bits() >> 11) + 0.5) * 0x1.0p-53;
}

double RandomStream::Uniform(double lower, double upper) noexcept {
  return lower + (upper - lower) * Uniform();
}

double RandomStream::Gaussian() noexcept {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  const double radius = std::sqrt(-2.0 * std::log(Uniform()));
  const double angle_rad = 2.0 * std::numbers::pi * Uniform();
  spare_ = radius * std::sin(angle_rad);
  has_spare_ = true;
  return radius * std::cos(angle_rad);
}

}  // namespace sinew::surrogate

#include "sim/world/sensor_errors.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace sinew::world {

namespace {

// SplitMix64 (Steele, Lea, Flood: Fast splittable pseudorandom number generators, OOPSLA 2014).
std::uint64_t MixedSeed(std::uint64_t seed, std::uint64_t stream) noexcept {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15ULL * (stream + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

[[noreturn]] void RefuseErrors(std::string_view what, const std::string& why) {
  throw std::invalid_argument("errors of " + std::string(what) + ": " + why);
}

void CheckErrors(std::string_view what, const SensorErrors& errors) {
  const struct {
    const char* name;
    double value;
  } rows[] = {{"bandwidth", errors.bandwidth_Hz},
              {"noise density", errors.noise_density},
              {"bias", errors.bias},
              {"scale error", errors.scale_error},
              {"step", errors.step},
              {"range", errors.range}};
  for (const auto& row : rows) {
    if (std::isfinite(row.value) && row.value >= 0.0) continue;
    RefuseErrors(
        what, std::string(row.name) + " = " + std::to_string(row.value) + ", expected 0 or more");
  }
  if (errors.noise_density > 0.0 && errors.bandwidth_Hz == 0.0) {
    RefuseErrors(what, "a noise density needs a bandwidth above 0 Hz");
  }
  if (errors.scale_error >= 1.0) {
    RefuseErrors(what,
                 "scale error = " + std::to_string(errors.scale_error) + ", expected below 1");
  }
}

}  // namespace

SensorRow::SensorRow(std::string_view what, const SensorErrors& errors, std::size_t count,
                     std::uint64_t seed, std::uint64_t stream)
    : errors_(errors),
      deviation_(errors.noise_density * std::sqrt(0.5 * std::numbers::pi * errors.bandwidth_Hz)),
      seed_(MixedSeed(seed, stream)),
      low_passed_(count),
      bias_(count),
      scale_(count, 1.0) {
  CheckErrors(what, errors);
}

double SensorRow::Uniform() noexcept {
  return (static_cast<double>(bits_() >> 11) + 0.5) * 0x1.0p-53;
}

// Box, Muller 1958, one of the pair; std::normal_distribution differs between libraries.
double SensorRow::Normal() noexcept {
  const double radius = std::sqrt(-2.0 * std::log(Uniform()));
  return radius * std::cos(2.0 * std::numbers::pi * Uniform());
}

void SensorRow::Reset(std::span<const double> truth) noexcept {
  bits_.seed(seed_);
  for (std::size_t i = 0; i < low_passed_.size(); ++i) {
    bias_[i] = errors_.bias * (2.0 * Uniform() - 1.0);
    scale_[i] = 1.0 + errors_.scale_error * (2.0 * Uniform() - 1.0);
  }
  std::copy_n(truth.begin(), low_passed_.size(), low_passed_.begin());
}

void SensorRow::Follow(std::span<const double> truth, double dt_s) noexcept {
  const double turn = 2.0 * std::numbers::pi * errors_.bandwidth_Hz * dt_s;
  const double share = errors_.bandwidth_Hz > 0.0 ? turn / (1.0 + turn) : 1.0;
  for (std::size_t i = 0; i < low_passed_.size(); ++i) {
    low_passed_[i] = share < 1.0 ? low_passed_[i] + share * (truth[i] - low_passed_[i]) : truth[i];
  }
}

void SensorRow::Read(std::span<double> reading) noexcept {
  for (std::size_t i = 0; i < low_passed_.size(); ++i) {
    double value = scale_[i] * low_passed_[i] + bias_[i];
    if (deviation_ > 0.0) value += deviation_ * Normal();
    if (errors_.step > 0.0) value = errors_.step * std::round(value / errors_.step);
    if (errors_.range > 0.0) value = std::clamp(value, -errors_.range, errors_.range);
    reading[i] = value;
  }
}

}  // namespace sinew::world

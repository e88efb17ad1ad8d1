// Errors of the simulated sensors against their own description: statistics of many samples, exact
// values where nothing is random.
#include "sim/world/sensor_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace sinew::world {
namespace {

using Three = std::array<double, 3>;
constexpr std::size_t kThree = 3;
constexpr double kSample_s = 1.0 / 240.0;
constexpr int kSamples = 20000;

TEST(SensorErrors, WithoutAnyTheReadingIsTheTruthToTheBit) {
  SensorRow row("test", {}, kThree, 1, 0);
  Three truth{0.1, -1e9, 1e-12}, read{};
  row.Reset(truth);
  row.Read(read);
  EXPECT_EQ(read, truth);
  truth = {3.0, 2.0, 1.0};
  row.Follow(truth, kSample_s);
  row.Read(read);
  EXPECT_EQ(read, truth);
}

TEST(SensorErrors, NoiseHasTheDensityTimesTheRootOfTheNoiseBandwidth) {
  const SensorErrors errors{.bandwidth_Hz = 100.0, .noise_density = 4e-3};
  SensorRow row("test", errors, kThree, 5, 0);
  Three read{};
  row.Reset(Three{1.0, 2.0, 3.0});
  std::array<std::vector<double>, kThree> noise;
  for (int k = 0; k < kSamples; ++k) {
    row.Read(read);
    for (std::size_t i = 0; i < kThree; ++i) {
      noise[i].push_back(read[i] - 1.0 - static_cast<double>(i));
    }
  }
  const double expected = 4e-3 * std::sqrt(0.5 * std::numbers::pi * 100.0);
  for (const std::vector<double>& axis : noise) {
    double sum = 0.0, squares = 0.0, products = 0.0;
    for (std::size_t k = 0; k < axis.size(); ++k) {
      sum += axis[k];
      squares += axis[k] * axis[k];
      if (k > 0) products += axis[k] * axis[k - 1];
    }
    // Standard errors: of a deviation 1 / sqrt(2 n), of a mean and a correlation 1 / sqrt(n); four.
    EXPECT_NEAR(std::sqrt(squares / kSamples), expected,
                4.0 * expected / std::sqrt(2.0 * kSamples));
    EXPECT_NEAR(sum / kSamples, 0.0, 4.0 * expected / std::sqrt(kSamples));
    EXPECT_NEAR(products / squares, 0.0, 4.0 / std::sqrt(kSamples)) << "samples are independent";
  }
}

TEST(SensorErrors, BiasAndScaleAreWithinTheirBoundsAndOfTheSeed) {
  const SensorErrors errors{.bias = 0.5, .scale_error = 0.03};
  double least = 1.0, most = -1.0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    SensorRow row("test", errors, kThree, seed, 2), same("test", errors, kThree, seed, 2);
    SensorRow other("test", errors, kThree, seed, 3);
    Three zero{}, read{}, again{}, elsewhere{};
    row.Reset(Three{});
    row.Read(zero);
    row.Reset(Three{10.0, 10.0, 10.0});
    row.Read(read);
    same.Reset(Three{10.0, 10.0, 10.0});
    same.Read(again);
    other.Reset(Three{10.0, 10.0, 10.0});
    other.Read(elsewhere);
    EXPECT_EQ(read, again);
    EXPECT_NE(read, elsewhere) << "rows of one seed differ";
    for (std::size_t i = 0; i < kThree; ++i) {
      EXPECT_LE(std::abs(zero[i]), 0.5);
      EXPECT_LE(std::abs((read[i] - zero[i]) / 10.0 - 1.0), 0.03);
      least = std::min(least, zero[i]);
      most = std::max(most, zero[i]);
    }
  }
  EXPECT_LT(least, -0.45) << "the whole width is used";
  EXPECT_GT(most, 0.45);
}

TEST(SensorErrors, TheConverterHasStepsAndARange) {
  SensorRow row("test", {.step = 0.25, .range = 2.0}, kThree, 1, 0);
  Three read{};
  row.Reset(Three{0.3, -0.4, 1.9});
  row.Read(read);
  EXPECT_EQ(read, (Three{0.25, -0.5, 2.0}));
  row.Follow(Three{100.0, -100.0, 0.0}, kSample_s);
  row.Read(read);
  EXPECT_EQ(read, (Three{2.0, -2.0, 0.0}));
}

// A step of the truth: 1 - (1 + 2 pi f h)^-n after n steps of h, near 1 - exp(-2 pi f t).
TEST(SensorErrors, TheLowPassHasItsTimeConstant) {
  constexpr double kStep_s = 1e-5, kBandwidth_Hz = 100.0;
  SensorRow row("test", {.bandwidth_Hz = kBandwidth_Hz}, kThree, 1, 0);
  row.Reset(Three{});
  Three read{};
  const int steps =
      static_cast<int>(std::lround(1.0 / (2.0 * std::numbers::pi * kBandwidth_Hz) / kStep_s));
  for (int k = 0; k < steps; ++k) row.Follow(Three{1.0, 1.0, 1.0}, kStep_s);
  row.Read(read);
  EXPECT_NEAR(read[0], 1.0 - std::exp(-1.0), 0.005) << "backward Euler: half a step, and rounding";
}

TEST(SensorErrors, TheMpu6050IsWithinTheBoundsOfTheFallDetector) {
  const double force = kMpu6050.force.noise_density *
                       std::sqrt(0.5 * std::numbers::pi * kMpu6050.force.bandwidth_Hz);
  EXPECT_LE(force, 0.05);
  EXPECT_GT(force, 2.0 * kMpu6050.force.step) << "a healthy sample repeats itself rarely";
  EXPECT_LE(kMpu6050.force.bias * std::sqrt(2.0), 0.7);
}

TEST(SensorErrors, WhatCannotBeIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [](const SensorErrors& errors) {
    EXPECT_THROW(SensorRow("test", errors, kThree, 1, 0), std::invalid_argument);
  };
  refused({.bandwidth_Hz = -1.0});
  refused({.bandwidth_Hz = nan});
  refused({.noise_density = 1.0});
  refused({.bias = -1.0});
  refused({.scale_error = 1.0});
  refused({.step = nan});
  refused({.range = -1.0});
}

}  // namespace
}  // namespace sinew::world

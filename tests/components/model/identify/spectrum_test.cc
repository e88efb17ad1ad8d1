#include "components/model/identify/spectrum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace sinew::identify {
namespace {

TEST(Spectrum, TransformAgreesWithItsDefinition) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const std::size_t size : {1U, 2U, 8U, 12U, 15U, 64U}) {
    std::vector<double> x(size);
    for (double& value : x) value = normal(random);
    const std::vector<std::complex<double>> fast = FourierTransform(x);
    ASSERT_EQ(fast.size(), size / 2 + 1);
    for (std::size_t k = 0; k < fast.size(); ++k) {
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < size; ++i) {
        sum += x[i] * std::polar(1.0, -2.0 * M_PI * static_cast<double>(k * i) /
                                          static_cast<double>(size));
      }
      EXPECT_NEAR(std::abs(fast[k] - sum), 0.0, 1e-12) << size << ", " << k;
    }
  }
}

TEST(Spectrum, DensityIntegratesToTheVariance) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(2.0, 3.0);
  Eigen::VectorXd x(65536);
  for (double& value : x) value = normal(random);
  const Spectrum spectrum = PowerDensity(x, 200.0, 512);
  const double df = spectrum.frequency_Hz[1];
  EXPECT_NEAR(spectrum.density.sum() * df, 9.0, 0.2);  // 256 pieces: 1 % of noise, Hann edges
}

TEST(Spectrum, BandEndsWhereMotionSinksIntoNoise) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal(0.0, 1e-4);
  Eigen::VectorXd x(8192);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / 100.0;
    x[i] = std::sin(2.0 * M_PI * 1.0 * t) + normal(random);
  }
  const double band_Hz = PowerDensity(x, 100.0).BandAboveNoise();
  EXPECT_GT(band_Hz, 1.0);
  EXPECT_LT(band_Hz, 12.0);
}

TEST(Spectrum, BandOfMotionHoldsTheShareOfTheVelocityThatWasAskedFor) {
  Eigen::VectorXd x(8192);
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double t = static_cast<double>(i) / 100.0;
    // Velocities of 1 at 1 Hz and of 0.1 at 8 Hz: a hundredth of the power.
    x[i] = std::sin(2.0 * M_PI * 1.0 * t) + 0.1 / 8.0 * std::sin(2.0 * M_PI * 8.0 * t);
  }
  EXPECT_NEAR(PowerDensity(x, 100.0).BandOfMotion(0.95), 1.0, 0.3);
  EXPECT_NEAR(PowerDensity(x, 100.0).BandOfMotion(0.999), 8.0, 0.5);
}

TEST(Spectrum, BandOfLeastErrorEndsWhereSignalAndNoiseAreAlike) {
  // A random walk has the spectrum 1 / (2 sin(pi f / rate))^2, white noise of standard deviation s
  // s^2: alike at f = rate / pi * asin(1 / (2 s)).
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  Eigen::VectorXd x(1 << 17);
  double walk = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    walk += normal(random);
    x[i] = walk + 5.0 * normal(random);
  }
  const double expected_Hz = 100.0 / M_PI * std::asin(1.0 / 10.0);
  EXPECT_NEAR(PowerDensity(x, 100.0).BandOfLeastError(1), expected_Hz, 0.35 * expected_Hz);
}

TEST(Spectrum, ShortInputHasNoSpectrum) {
  EXPECT_EQ(PowerDensity(Eigen::VectorXd::Zero(7), 10.0).density.size(), 0);
  EXPECT_EQ(PowerDensity(Eigen::VectorXd::Zero(7), 10.0).BandAboveNoise(), 0.0);
}

}  // namespace
}  // namespace sinew::identify

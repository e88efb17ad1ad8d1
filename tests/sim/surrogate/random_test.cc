#include "sim/surrogate/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew::surrogate {
namespace {

TEST(RandomStream, SameSeedAndStreamGiveTheSameBits) {
  RandomStream a(7, 3), b(7, 3);
  for (int i = 0; i < 1000; ++i) ASSERT_EQ(a.Bits(), b.Bits());
}

TEST(RandomStream, OtherSeedsAndStreamsAreUnrelated) {
  RandomStream a(7, 3), other_seed(8, 3), other_stream(7, 4);
  double seed_product = 0.0, stream_product = 0.0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double x = a.Gaussian();
    seed_product += x * other_seed.Gaussian();
    stream_product += x * other_stream.Gaussian();
  }
  const double kFourSigma = 4.0 * std::sqrt(static_cast<double>(kCount));
  EXPECT_LT(std::abs(seed_product), kFourSigma);
  EXPECT_LT(std::abs(stream_product), kFourSigma);
}

TEST(RandomStream, GaussianHasTheMomentsOfANormalDistribution) {
  RandomStream random(1, 1);
  constexpr int kCount = 400000;
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.Gaussian();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  // Four standard errors: 1, sqrt(2) and sqrt(96) over sqrt(count).
  const double root = std::sqrt(static_cast<double>(kCount));
  EXPECT_NEAR(sum / kCount, 0.0, 4.0 / root);
  EXPECT_NEAR(square / kCount, 1.0, 4.0 * std::sqrt(2.0) / root);
  EXPECT_NEAR(fourth / kCount, 3.0, 4.0 * std::sqrt(96.0) / root);
}

TEST(RandomStream, UniformStaysInsideItsLimits) {
  RandomStream random(1, 2);
  for (int i = 0; i < 100000; ++i) {
    const double x = random.Uniform(-2.0, 3.0);
    ASSERT_GT(x, -2.0);
    ASSERT_LT(x, 3.0);
  }
}

}  // namespace
}  // namespace sinew::surrogate

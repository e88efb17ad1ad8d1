#include "sim/plant/friction.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace sinew::plant {
namespace {

TEST(ApplyImpulses, StopsOneBodyExactlyWhenTheBoundSuffices) {
  const double inverse = 3.0, lower = -0.1, upper = 0.1;
  double impulse = 0.0, velocity = 0.29;
  ApplyImpulses({&inverse, 1}, {&lower, 1}, {&upper, 1}, {&impulse, 1}, {&velocity, 1});
  EXPECT_EQ(velocity, 0.0);
  velocity = 0.31;
  ApplyImpulses({&inverse, 1}, {&lower, 1}, {&upper, 1}, {&impulse, 1}, {&velocity, 1});
  EXPECT_NEAR(velocity, 0.01, 1e-15);
  EXPECT_EQ(impulse, -0.1);
}

TEST(ApplyImpulses, HoldsAgainstAStopHoweverHardItIsHit) {
  const double inverse = 0.5, lower = -std::numeric_limits<double>::infinity(), upper = 0.0;
  double impulse = 0.0, velocity = 1e6;
  ApplyImpulses({&inverse, 1}, {&lower, 1}, {&upper, 1}, {&impulse, 1}, {&velocity, 1});
  EXPECT_EQ(velocity, 0.0);
  velocity = -1.0;  // away from the stop
  ApplyImpulses({&inverse, 1}, {&lower, 1}, {&upper, 1}, {&impulse, 1}, {&velocity, 1});
  EXPECT_EQ(velocity, -1.0);
}

// The law itself: impulses within their bounds, and opposed to what still moves.
TEST(ApplyImpulses, SolvesCoupledBodies) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  constexpr std::size_t kJoints = 3;
  for (int trial = 0; trial < 200; ++trial) {
    std::array<double, 9> half{}, inverse{};
    for (double& value : half) value = normal(random);
    for (std::size_t i = 0; i < kJoints; ++i) {
      for (std::size_t k = 0; k < kJoints; ++k) {
        inverse[i * kJoints + k] = i == k ? 1.0 : 0.0;
        for (std::size_t m = 0; m < kJoints; ++m) {
          inverse[i * kJoints + k] += half[i * kJoints + m] * half[k * kJoints + m];
        }
      }
    }
    std::array<double, 3> lower{}, upper{}, impulse{}, free{}, velocity{};
    for (std::size_t i = 0; i < kJoints; ++i) {
      upper[i] = std::abs(normal(random));
      lower[i] = -upper[i];
      free[i] = velocity[i] = normal(random);
    }
    ApplyImpulses(inverse, lower, upper, impulse, velocity);
    std::array<double, 3> from{normal(random), normal(random), normal(random)}, same = free;
    ApplyImpulsesFrom(inverse, lower, upper, from, same);
    for (std::size_t i = 0; i < kJoints; ++i) EXPECT_NEAR(same[i], velocity[i], 1e-9);
    for (std::size_t i = 0; i < kJoints; ++i) {
      double expected = free[i];
      for (std::size_t k = 0; k < kJoints; ++k) expected += inverse[i * kJoints + k] * impulse[k];
      EXPECT_NEAR(velocity[i], expected, 1e-9);  // 100 rounds of Gauss-Seidel
      EXPECT_LE(std::abs(impulse[i]), upper[i]);
      if (velocity[i] > 1e-9) {
        EXPECT_EQ(impulse[i], lower[i]);
      } else if (velocity[i] < -1e-9) {
        EXPECT_EQ(impulse[i], upper[i]);
      }
    }
  }
}

}  // namespace
}  // namespace sinew::plant

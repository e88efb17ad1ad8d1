// Oracle: derivatives in closed form.
#include "components/robot/residual/moving_states.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::residual {
namespace {

constexpr double kWindowPeriod_s = 1.0 / 240.0;

JointReading At(double position_rad) {
  return {.valid = true,
          .position_rad = position_rad,
          .motor_position_rad = 100.0 * position_rad,
          .drive_input = 2.0 * position_rad,
          .pressure_bar = 3.0 * position_rad};
}

TEST(MovingStates, AreExactForAQuarticInTheMiddleOfTheWindow) {
  MovingStates states(kWindowPeriod_s, 0.1);
  effects::JointSample x;
  const auto q = [](double t) { return 0.3 + t * (0.5 + t * (-0.7 + t * (0.2 + 0.4 * t))); };
  bool known = false;
  double t = 0.0;
  for (int i = 0; i < 60; ++i) {
    t = i * kWindowPeriod_s;
    known = states.Push(At(q(t)), t, &x);
    EXPECT_EQ(known, i >= 2 * states.half_window()) << i;
  }
  const double m = t - states.delay_s();
  EXPECT_NEAR(x.time_s, m, 1e-12);
  EXPECT_NEAR(x.position_rad, q(m), 1e-12);
  EXPECT_NEAR(x.velocity_rad_s, 0.5 + m * (-1.4 + m * (0.6 + 1.6 * m)), 1e-9);
  EXPECT_NEAR(x.acceleration_rad_s2, -1.4 + m * (1.2 + 4.8 * m), 1e-7);
  EXPECT_NEAR(x.jerk_rad_s3, 1.2 + 9.6 * m, 1e-4);
  EXPECT_NEAR(x.snap_rad_s4, 9.6, 1e-2);
  EXPECT_NEAR(x.motor_velocity_rad_s, 100.0 * x.velocity_rad_s, 1e-7);
  EXPECT_NEAR(x.drive_rate, 2.0 * x.velocity_rad_s, 1e-9);
  EXPECT_NEAR(x.pressure_rate_bar_s, 3.0 * x.velocity_rad_s, 1e-9);
}

TEST(MovingStates, KeepASineUpToTwoHertzWithinAPercent) {
  for (const double frequency_Hz : {0.4, 2.0}) {
    const double w = 2.0 * M_PI * frequency_Hz;
    MovingStates states(kWindowPeriod_s, 0.1);
    effects::JointSample x;
    double worst = 0.0;
    for (int i = 0; i < 480; ++i) {
      const double t = i * kWindowPeriod_s;
      if (!states.Push(At(std::sin(w * t)), t, &x)) continue;
      worst = std::max(worst, std::abs(x.acceleration_rad_s2 + w * w * std::sin(w * x.time_s)));
    }
    EXPECT_LT(worst, 0.01 * w * w) << frequency_Hz;
  }
}

TEST(MovingStates, ALostOrBrokenSampleIsInNoWindow) {
  MovingStates states(kWindowPeriod_s, 0.1);
  effects::JointSample x;
  const int width = 2 * states.half_window() + 1;
  int i = 0;
  const auto push = [&](JointReading reading) {
    return states.Push(reading, kWindowPeriod_s * i++, &x);
  };
  for (int k = 0; k < width; ++k) push(At(0.1));
  JointReading lost = At(0.1);
  lost.valid = false;
  EXPECT_FALSE(push(lost));
  for (int k = 1; k < width; ++k) EXPECT_FALSE(push(At(0.1))) << k;
  EXPECT_TRUE(push(At(0.1)));
  JointReading broken = At(NAN);
  EXPECT_FALSE(push(broken));
  for (int k = 1; k < width; ++k) EXPECT_FALSE(push(At(0.1))) << k;
  EXPECT_TRUE(push(At(0.1)));
  EXPECT_EQ(x.velocity_rad_s, x.velocity_rad_s);
}

TEST(MovingStates, TakesNoMemoryAndRefusesBadWindows) {
  MovingStates states(kWindowPeriod_s, 0.1);
  effects::JointSample x;
  const long before = test::Allocations();
  for (int i = 0; i < 500; ++i) states.Push(At(0.001 * i), kWindowPeriod_s * i, &x);
  EXPECT_EQ(test::Allocations(), before);
  EXPECT_THROW(MovingStates(0.0, 0.1), std::invalid_argument);
  EXPECT_THROW(MovingStates(kWindowPeriod_s, -0.1), std::invalid_argument);
  EXPECT_THROW(MovingStates(1e-9, 0.1), std::invalid_argument);
  EXPECT_THROW(MovingStates(NAN, 0.1), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::residual

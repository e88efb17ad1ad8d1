#include "sim/surrogate/slip.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "sim/surrogate/random.h"

namespace sinew::surrogate {
namespace {

constexpr double kSlipStep_s = 1.0 / 24000.0;
constexpr double kInertia_kg_m2 = 0.019;

// A body of the link's inertia on the bank, pushed with a constant torque.
struct Body {
  SlipBank bank;
  double angle_rad = 0.0;
  double velocity_rad_s = 0.0;
  void Push(double torque_Nm, double seconds) {
    for (int i = 0; i < static_cast<int>(seconds / kSlipStep_s); ++i) {
      const double friction_Nm = bank.Step(velocity_rad_s, kSlipStep_s);
      velocity_rad_s += kSlipStep_s * (torque_Nm + friction_Nm) / kInertia_kg_m2;
      angle_rad += kSlipStep_s * velocity_rad_s;
    }
  }
};

TEST(SlipBank, NoMotionGivesNoTorque) {
  SlipBank bank{SlipParameters{}};
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(bank.Step(0.0, kSlipStep_s), 0.0);
}

TEST(SlipBank, HoldsWithoutCreepingUnderATorqueBelowBreakaway) {
  Body body{SlipBank{SlipParameters{}}};
  body.Push(0.2, 2.0);
  const double after_two_s_rad = body.angle_rad;
  body.Push(0.2, 30.0);
  // What is left of the first swing, far below an encoder count of 3.8e-4 rad.
  EXPECT_NEAR(body.angle_rad, after_two_s_rad, 1e-9);
  EXPECT_LT(std::abs(body.velocity_rad_s), 1e-9);
}

TEST(SlipBank, SlidingTorqueIsTheKineticOneAtAnySpeed) {
  for (const double speed_rad_s : {0.02, 0.2, 2.0, -0.02, -2.0}) {
    SlipBank bank{SlipParameters{}};
    double torque_Nm = 0.0;
    for (int i = 0; i < 24000; ++i) torque_Nm = bank.Step(speed_rad_s, kSlipStep_s);
    // The contacts' age while sliding is D/v = 0.05 s at 0.02 rad/s: 0.0004 N·m.
    EXPECT_NEAR(torque_Nm, std::copysign(0.22, -speed_rad_s), 5e-4) << speed_rad_s;
  }
}

TEST(SlipBank, YieldTorqueGrowsWithTheTimeAtRest) {
  const SlipParameters parameters;
  for (const double rest_s : {0.0, 0.25, 2.0, 10.0, 60.0}) {
    SlipBank bank{parameters};
    bank.Reset(rest_s);
    bank.Step(0.0, kSlipStep_s);
    const double expected_Nm =
        parameters.kinetic_Nm +
        parameters.rest_growth_Nm *
            (1.0 - std::exp(-std::pow(rest_s / parameters.rest_time_s, 1.5)));
    EXPECT_NEAR(bank.yield_Nm(), expected_Nm, 1e-6) << rest_s;
  }
}

TEST(SlipBank, ContactsAgeASecondPerSecondOfRestAndWearToDistanceOverSpeed) {
  const SlipParameters parameters;
  SlipBank bank{parameters};
  for (int i = 0; i < 3 * 24000; ++i) bank.Step(0.0, kSlipStep_s);
  EXPECT_NEAR(bank.age_s(), 3.0, 1e-6);
  for (int i = 0; i < 24000; ++i) bank.Step(0.1, kSlipStep_s);
  EXPECT_NEAR(bank.age_s(), parameters.renewal_distance_rad / 0.1, 1e-4);
}

TEST(SlipBank, BreaksAwayNearItsYieldTorqueAfterALongRest) {
  const auto moved_rad = [](double torque_Nm) {
    Body body{SlipBank{SlipParameters{}}};
    body.bank.Reset(120.0);
    for (int i = 1; i <= 200; ++i) body.Push(torque_Nm * i / 200.0, 0.01);  // no shock
    body.Push(torque_Nm, 1.0);
    return body.angle_rad;
  };
  EXPECT_LT(moved_rad(1.15), 0.005);
  EXPECT_GT(moved_rad(1.25), 0.1);
}

TEST(SlipBank, OnlyTakesEnergyWhateverTheMotion) {
  RandomStream random(3, 1);
  SlipBank bank{SlipParameters{}};
  bank.Reset(20.0);
  double velocity_rad_s = 0.0, given_J = 0.0;
  for (int i = 0; i < 400000; ++i) {
    if (i % 300 == 0)
      velocity_rad_s = random.Gaussian() * std::pow(10.0, random.Uniform(-4.0, 0.5));
    given_J += -bank.Step(velocity_rad_s, kSlipStep_s) * velocity_rad_s * kSlipStep_s;
    // What was given is at least what the springs hold: nothing comes back that was not put in. The
    // torque is that at the end of the step, so a spring is charged in steps: the tolerance is one
    // step's error.
    ASSERT_GE(given_J - bank.spring_energy_J(), -1e-6) << i;
  }
  EXPECT_GT(given_J, 1.0);
}

TEST(SlipBank, StaysFiniteOverALongRun) {
  SlipBank bank{SlipParameters{}};
  double torque_Nm = 0.0;
  for (int i = 0; i < 3000000; ++i) torque_Nm = bank.Step(std::sin(1e-3 * i), kSlipStep_s);
  EXPECT_TRUE(std::isfinite(torque_Nm));
  EXPECT_LE(std::abs(torque_Nm), 1.3);
}

TEST(SlipBank, RefusesParametersWithoutMeaning) {
  EXPECT_THROW(SlipBank({.kinetic_Nm = -0.1}), std::invalid_argument);
  EXPECT_THROW(SlipBank({.rest_time_s = 0.0}), std::invalid_argument);
  EXPECT_THROW(SlipBank({.presliding_rad = std::numeric_limits<double>::quiet_NaN()}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate

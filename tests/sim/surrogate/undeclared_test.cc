#include "sim/surrogate/undeclared.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/surrogate/rig.h"

namespace sinew::surrogate {
namespace {

constexpr double kEffectStep_s = 1e-4;

Undeclared Make(const std::string& name, double size, double from_s = 0.0) {
  return Undeclared({{name, size, from_s}}, 100.0);
}

TEST(Undeclared, NoneDoesNothing) {
  Undeclared none({}, 100.0);
  const EffectState state{1.0, 50.0, 0.5, 4.0};
  EXPECT_EQ(none.ExtraFriction_Nm(state), 0.0);
  EXPECT_EQ(none.OutputTorque_Nm(state, kEffectStep_s), 0.0);
  EXPECT_EQ(none.RotorTorque_Nm(state), 0.0);
  EXPECT_EQ(none.payload_kg(), 0.0);
}

TEST(Undeclared, FiveNamesAreOutsideOfTheCatalogue) {
  std::vector<std::string> outside;
  for (const EffectInfo& info : UndeclaredEffects()) {
    if (!info.in_catalogue) outside.emplace_back(info.name);
    EXPECT_LE(info.smallest_size, 0.0) << info.name;
    EXPECT_GT(info.default_size, 0.0) << info.name;
    EXPECT_LE(info.default_size, info.largest_size) << info.name;
  }
  EXPECT_EQ(outside, (std::vector<std::string>{"cable_drag", "bad_tooth", "supply_sag", "slow_tilt",
                                               "slipping_magnet"}));
  // The list and the enumeration have the same order.
  ASSERT_EQ(UndeclaredEffects().size(), static_cast<std::size_t>(Effect::kCount));
  for (std::size_t i = 0; i < UndeclaredEffects().size(); ++i) {
    const EffectInfo& info = UndeclaredEffects()[i];
    const Undeclared one = Make(std::string(info.name), info.default_size);
    EXPECT_EQ(one.size(static_cast<Effect>(i)), info.default_size) << info.name;
  }
  EXPECT_EQ(UndeclaredEffects()[static_cast<std::size_t>(Effect::kLeak)].name, "leak");
  EXPECT_EQ(UndeclaredEffects()[static_cast<std::size_t>(Effect::kCableDrag)].name, "cable_drag");
}

TEST(Undeclared, StribeckFrictionIsWholeAtCreepAndGoneAtSpeed) {
  const Undeclared effect = Make("stribeck", 0.1);
  EXPECT_EQ(effect.ExtraFriction_Nm({}), 0.1);
  double before_Nm = 0.1;
  for (double speed_rad_s = 0.005; speed_rad_s < 1.0; speed_rad_s += 0.005) {
    const double now_Nm = effect.ExtraFriction_Nm({.output_velocity_rad_s = speed_rad_s});
    ASSERT_LE(now_Nm, before_Nm);
    ASSERT_EQ(now_Nm, effect.ExtraFriction_Nm({.output_velocity_rad_s = -speed_rad_s}));
    before_Nm = now_Nm;
  }
  EXPECT_EQ(before_Nm, 0.0);
}

TEST(Undeclared, ViscousFrictionDiffersByItsSizeBetweenTheDirections) {
  Undeclared effect = Make("direction_dependent_viscous", 0.2);
  const double up_Nm = effect.OutputTorque_Nm({0.0, 0.0, 1.0, 0.0}, kEffectStep_s);
  const double down_Nm = effect.OutputTorque_Nm({0.0, 0.0, -1.0, 0.0}, kEffectStep_s);
  // Coefficients: torque / -velocity.
  EXPECT_DOUBLE_EQ(-up_Nm - down_Nm, 0.2);
  EXPECT_DOUBLE_EQ(up_Nm - down_Nm, 0.0);
}

TEST(Undeclared, CoggingRepeatsEveryTurnWithTheOrdersOfMagnetsAndPolePairs) {
  const Undeclared effect = Make("cogging", 1e-3);
  constexpr int kPoints = 4096;
  std::vector<double> torque_Nm(kPoints);
  double largest_Nm = 0.0;
  for (int i = 0; i < kPoints; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kPoints;
    torque_Nm[i] = effect.RotorTorque_Nm({angle_rad, 0.0, 0.0, 0.0});
    EXPECT_NEAR(torque_Nm[i], effect.RotorTorque_Nm({angle_rad - 6.0 * std::numbers::pi, 0, 0, 0}),
                1e-12);
    largest_Nm = std::max(largest_Nm, std::abs(torque_Nm[i]));
  }
  EXPECT_NEAR(largest_Nm, 1e-3, 1e-6);
  std::vector<double> amplitude(60);
  for (int order = 0; order < 60; ++order) {
    std::complex<double> sum = 0.0;
    for (int i = 0; i < kPoints; ++i) {
      sum += torque_Nm[i] * std::polar(1.0, -2.0 * std::numbers::pi * order * i / kPoints);
    }
    amplitude[order] = 2.0 * std::abs(sum) / kPoints;
  }
  EXPECT_LT(amplitude[0], 1e-2 * amplitude[14]);  // no mean torque
  EXPECT_GT(amplitude[14], 0.5e-3);
  EXPECT_GT(amplitude[7], 5.0 * amplitude[9]);
  EXPECT_GT(amplitude[28], 5.0 * amplitude[23]);
  for (int order = 1; order < 60; ++order) {
    if (order == 14) continue;
    EXPECT_LT(amplitude[order], amplitude[14]) << order;
  }
}

TEST(Undeclared, SealLoopIsAsWideAsPressureAndSizeSay) {
  for (const double pressure_bar : {0.0, 2.0, 5.0}) {
    Undeclared effect = Make("seal_hysteresis", 0.02);
    const auto sweep = [&](double velocity_rad_s, double seconds) {
      double torque_Nm = 0.0;
      for (int i = 0; i < static_cast<int>(seconds / kEffectStep_s); ++i) {
        torque_Nm = effect.OutputTorque_Nm({0.0, 0.0, velocity_rad_s, pressure_bar}, kEffectStep_s);
      }
      return torque_Nm;
    };
    const double up_Nm = sweep(0.5, 2.0);
    const double small_reversal_Nm = sweep(-0.5, 0.05);  // 0.025 rad back: part of the loop only
    const double down_Nm = sweep(-0.5, 2.0);
    EXPECT_NEAR(up_Nm, -0.02 * pressure_bar, 1e-9);
    EXPECT_NEAR(down_Nm, 0.02 * pressure_bar, 1e-9);
    if (pressure_bar > 0.0) {
      EXPECT_GT(small_reversal_Nm, up_Nm);
      EXPECT_LT(small_reversal_Nm, down_Nm);
    }
  }
}

TEST(Undeclared, SealTakesEnergyOverEveryClosedLoop) {
  Undeclared effect = Make("seal_hysteresis", 0.02);
  double work_J = 0.0;
  for (int i = 0; i < 200000; ++i) {
    const double velocity_rad_s = 0.5 * std::cos(2.0 * std::numbers::pi * i * kEffectStep_s);
    work_J += effect.OutputTorque_Nm({0.0, 0.0, velocity_rad_s, 4.0}, kEffectStep_s) *
              velocity_rad_s * kEffectStep_s;
  }
  EXPECT_LT(work_J, 0.0);
}

TEST(Undeclared, QuadraticDragGrowsWithTheSquareAgainstTheMotion) {
  const Undeclared effect = Make("quadratic_viscous", 0.1);
  // Size is the torque at the output for 1 rad/s of output; a hundredth of it at the rotor.
  EXPECT_DOUBLE_EQ(effect.RotorTorque_Nm({0.0, 100.0, 1.0, 0.0}), -0.001);
  EXPECT_DOUBLE_EQ(effect.RotorTorque_Nm({0.0, 200.0, 2.0, 0.0}), -0.004);
  EXPECT_DOUBLE_EQ(effect.RotorTorque_Nm({0.0, -200.0, -2.0, 0.0}), 0.004);
}

TEST(Undeclared, PayloadAddsGravityAndInertiaOnTheRig) {
  RigParameters p;
  p.effects = {{"payload", 0.5, 0.0}};
  p.rotor_locked = true;
  p.pneumatics.initial_pressure_bar = 0.0;
  p.link.friction.kinetic_Nm = 0.0;
  p.link.friction.rest_growth_Nm = 0.0;
  Rig rig{p};
  rig.Advance(RigInput{}, 1.0);
  // Hangs on the teeth and the air that it squeezed: they carry gravity.
  EXPECT_NEAR(rig.truth().tooth_torque_Nm + rig.truth().pneumatic_torque_Nm,
              (0.58 + 0.5 * 9.81 * 0.3) * std::cos(rig.truth().output_angle_rad), 1e-3);
  EXPECT_DOUBLE_EQ(rig.truth().payload_kg, 0.5);
  EXPECT_DOUBLE_EQ(rig.Read().declared_payload_kg, 0.0);  // nobody said so
}

TEST(Undeclared, ActsFromItsTimeOn) {
  RigParameters p;
  p.effects = {{"payload", 0.5, 1.0}};
  Rig rig{p};
  rig.Advance(RigInput{}, 0.99);
  EXPECT_EQ(rig.truth().payload_kg, 0.0);
  rig.Advance(RigInput{}, 0.02);
  EXPECT_EQ(rig.truth().payload_kg, 0.5);
  rig.Reset();
  rig.Advance(RigInput{}, 0.5);
  EXPECT_EQ(rig.truth().payload_kg, 0.0);
}

TEST(ParseEffect, ReadsNameSizeAndTime) {
  EXPECT_FALSE(ParseEffect("none").has_value());
  const EffectSpec plain = ParseEffect("cogging").value();
  EXPECT_EQ(plain.name, "cogging");
  EXPECT_EQ(plain.size, 1.9e-3);
  const EffectSpec full = ParseEffect("payload=0.7@12.5").value();
  EXPECT_EQ(full.name, "payload");
  EXPECT_EQ(full.size, 0.7);
  EXPECT_EQ(full.from_s, 12.5);
}

TEST(ParseEffect, RefusesWhatItDoesNotKnow) {
  EXPECT_THROW(ParseEffect("friction"), std::invalid_argument);
  EXPECT_THROW(ParseEffect("cogging=much"), std::invalid_argument);
  EXPECT_THROW(ParseEffect("cogging=nan"), std::invalid_argument);
  EXPECT_THROW(ParseEffect("cogging=5"), std::invalid_argument);
  EXPECT_THROW(ParseEffect("payload=0.5@-1"), std::invalid_argument);
  EXPECT_THROW(Undeclared({{"stribeck", -0.1, 0.0}}, 100.0), std::invalid_argument);
  EXPECT_THROW(Undeclared({{"nothing", 0.1, 0.0}}, 100.0), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::surrogate

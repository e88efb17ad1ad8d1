#include "sim/surrogate/rig.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "components/base/types/control_mode.h"
#include "tests/support/rig_constants.h"

namespace sinew::surrogate {
namespace {

RigParameters Lossless() {
  RigParameters p;
  p.rotor.viscous_Nm_s_rad = 0.0;
  p.rotor.friction.kinetic_Nm = 0.0;
  p.link.friction.kinetic_Nm = 0.0;
  p.link.friction.rest_growth_Nm = 0.0;
  p.gear.contact_damping_Nm_s_rad = 0.0;
  p.gear.share_drive = p.gear.share_back = 1.0;
  p.pneumatics.chamber_wall_W_K = 0.0;
  p.pneumatics.seal_leak.conductance_m3_sPa = 0.0;
  p.pneumatics.initial_valve_open = false;
  p.pneumatics.initial_pressure_bar = 2.0;
  return p;
}

// The drive idles: its current loop holds zero, so the rotor turns without electrical torque.
RigInput Idle() { return RigInput{}; }

TEST(Rig, EnergyIsKeptWithoutLosses) {
  Rig rig{Lossless()};
  rig.SetState(0.6 * 100.0, 0.0, 0.6, 0.0);
  rig.SetPressure(1.0, 1.0);
  const double start_J = rig.Energy().total_J();
  double largest_J = 0.0;
  double largest_kinetic_J = 0.0;
  for (int i = 0; i < 240 * 20; ++i) {
    rig.Advance(Idle(), kCycle_s);
    largest_J = std::max(largest_J, std::abs(rig.Energy().total_J() - start_J));
    largest_kinetic_J = std::max(largest_kinetic_J, rig.Energy().kinetic_J);
  }
  // Twenty seconds with hundreds of elastic tooth impacts; the drift is that of explicit impacts.
  EXPECT_GT(largest_kinetic_J, 0.03);
  EXPECT_LT(largest_J, 0.01 * largest_kinetic_J);
}

TEST(Rig, WearChangesDryAndViscousFrictionDuringARunAndResetTakesItBack) {
  RigParameters p;
  p.initial_rest_s = 0.0;
  p.pneumatics.initial_pressure_bar = 0.0;
  Rig rig{p};
  const auto friction_Nm = [&] {
    rig.SetState(0.0, 100.0, 0.0, 1.0);
    rig.Advance(Idle(), 0.01);
    return -rig.truth().friction_torque_Nm;
  };
  const auto slowing_rad_s = [&] {  // of the rotor by its own friction, inside the play
    rig.SetState(-2.0, 200.0, 0.0, 0.0);
    rig.Advance(Idle(), 0.01);
    return 200.0 - rig.truth().motor_velocity_rad_s;
  };
  const double dry_Nm = friction_Nm();
  const double slowing = slowing_rad_s();
  rig.Wear(1.5, 1.4);
  EXPECT_NEAR(friction_Nm() / dry_Nm, 1.5, 0.01);
  EXPECT_GT(slowing_rad_s(), 1.3 * slowing);
  EXPECT_LT(slowing_rad_s(), 1.41 * slowing);
  rig.Reset();
  EXPECT_NEAR(friction_Nm() / dry_Nm, 1.0, 0.01);
}

TEST(Rig, EnergyOnlyFallsWithFrictionAndTheMotorOff) {
  RigParameters p = Lossless();
  const RigParameters lossy;
  p.rotor = lossy.rotor;
  p.link = lossy.link;
  p.gear.contact_damping_Nm_s_rad = lossy.gear.contact_damping_Nm_s_rad;
  p.initial_rest_s = 0.0;
  Rig rig{p};
  rig.SetState(100.0, 0.0, 1.0, 3.0);
  double before_J = rig.Energy().total_J();
  const double start_J = before_J;
  for (int i = 0; i < 240 * 10; ++i) {
    rig.Advance(Idle(), kCycle_s);
    const double now_J = rig.Energy().total_J();
    // A tooth spring caught in mid-oscillation of the explicit scheme: far below what friction
    // takes.
    ASSERT_LE(now_J, before_J + 2e-6) << i;
    before_J = now_J;
  }
  EXPECT_LT(before_J, start_J - 0.05);
}

TEST(Rig, ToothImpactsNeverGainEnergy) {
  RigParameters p = Lossless();
  p.gear.contact_damping_Nm_s_rad = RigParameters{}.gear.contact_damping_Nm_s_rad;
  p.link.gravity_torque_Nm = 0.0;
  p.pneumatics.displacement_m3_rad = 0.0;
  for (const double speed_rad_s : {0.01, 0.1, 1.0, 5.0}) {
    Rig rig{p};
    rig.SetState(0.0, 0.0, 0.0, speed_rad_s);  // the link flies through the play to and fro
    const auto mechanical_J = [&] { return rig.Energy().kinetic_J + rig.Energy().contact_J; };
    double before_J = mechanical_J();
    const double start_J = before_J;
    // Long enough to cross the play ten times.
    const int steps = static_cast<int>(10.0 * p.gear.play_rad / speed_rad_s / p.step_s);
    for (int i = 0; i < steps; ++i) {
      rig.Advance(Idle(), p.step_s);
      const double now_J = mechanical_J();
      // Inside an impact the energy of the explicit scheme wavers by a thousandth.
      ASSERT_LE(now_J, before_J + 1e-3 * start_J) << speed_rad_s;
      before_J = std::min(before_J, now_J);
    }
    EXPECT_LT(before_J, 0.9 * start_J);
  }
}

TEST(Rig, MomentumPassesThroughTheTeethWhole) {
  RigParameters p = Lossless();
  p.link.gravity_torque_Nm = 0.0;
  p.pneumatics.displacement_m3_rad = 0.0;
  p.gear.contact_damping_Nm_s_rad = 10.0;
  Rig rig{p};
  rig.SetState(0.0, 0.0, 0.0, 2.0);
  const double reflected_kg_m2 = p.rotor.inertia_kg_m2 * p.gear.ratio * p.gear.ratio;
  const double start = p.link.inertia_kg_m2 * 2.0;
  for (int i = 0; i < 480; ++i) rig.Advance(Idle(), kCycle_s);
  const RigTruth t = rig.truth();
  const double now = p.link.inertia_kg_m2 * t.output_velocity_rad_s +
                     reflected_kg_m2 * t.motor_velocity_rad_s / p.gear.ratio;
  EXPECT_NEAR(now, start, 1e-6 * start);
}

TEST(Rig, MotorTorqueAcceleratesRotorAndLinkTogether) {
  RigParameters p = Lossless();
  p.link.gravity_torque_Nm = 0.0;
  p.pneumatics.displacement_m3_rad = 0.0;
  p.gear.contact_damping_Nm_s_rad = 10.0;
  p.gear.share_drive = p.gear.share_back = 0.77;
  Rig rig{p};
  const double half_play_rad = 0.5 * p.gear.play_rad;
  rig.SetState(half_play_rad * 100.0, 0.0, 0.0, 0.0);  // teeth touch
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 0.01};
  for (int i = 0; i < 120; ++i) rig.Advance(input, kCycle_s);
  const double from_rad_s = rig.truth().output_velocity_rad_s;
  for (int i = 0; i < 60; ++i) rig.Advance(input, kCycle_s);
  const double acceleration_rad_s2 = (rig.truth().output_velocity_rad_s - from_rad_s) / 0.25;
  const double inertia_kg_m2 = p.rotor.inertia_kg_m2 * 1e4 + p.link.inertia_kg_m2;
  EXPECT_NEAR(acceleration_rad_s2, 0.77 * 100.0 * 0.01 / inertia_kg_m2, 0.01);
}

TEST(Rig, ShareOfTheTorqueDependsOnTheDirectionOfPowerWhenConfigured) {
  RigParameters p = Lossless();
  p.gear.share_drive = 0.8;
  p.gear.share_back = 1.25;
  p.link.gravity_torque_Nm = 0.0;
  p.pneumatics.displacement_m3_rad = 0.0;
  p.gear.contact_damping_Nm_s_rad = 10.0;
  const double inertia_kg_m2 = p.rotor.inertia_kg_m2 * 1e4 + p.link.inertia_kg_m2;
  for (const double torque_Nm : {0.01, -0.01}) {
    Rig rig{p};
    const double half_play_rad = std::copysign(0.5 * p.gear.play_rad, torque_Nm);
    rig.SetState(half_play_rad * 100.0, 200.0, 0.0, 2.0);  // turning up
    RigInput input;
    input.drive = {types::ControlMode::kTorque, torque_Nm};
    for (int i = 0; i < 24; ++i) rig.Advance(input, kCycle_s);
    const double from_rad_s = rig.truth().output_velocity_rad_s;
    for (int i = 0; i < 24; ++i) rig.Advance(input, kCycle_s);
    const double expected_rad_s2 =
        (torque_Nm > 0.0 ? 0.8 : 1.25) * 100.0 * torque_Nm / inertia_kg_m2;
    EXPECT_NEAR((rig.truth().output_velocity_rad_s - from_rad_s) / 0.1, expected_rad_s2, 0.05);
  }
}

TEST(Rig, LoadFrictionTakesItsShareOfTheToothTorque) {
  // At the output: N T = J_rotor a + (1 + share) J_link a + the rotor's own dry friction.
  RigParameters p = Lossless();
  p.gear.contact_damping_Nm_s_rad = 10.0;
  p.link.gravity_torque_Nm = 0.0;
  p.link.inertia_kg_m2 = 0.1;
  p.pneumatics.displacement_m3_rad = 0.0;
  p.rotor.friction.kinetic_Nm = 2e-5;
  const double rotor_kg_m2 = p.rotor.inertia_kg_m2 * 1e4;
  for (const double share : {0.0, 0.4}) {
    p.gear.load_friction = share;
    Rig rig{p};
    rig.SetState(0.5 * p.gear.play_rad * 100.0, 200.0, 0.0, 2.0);  // in contact, turning up
    RigInput input;
    input.drive = {types::ControlMode::kTorque, 0.02};
    for (int i = 0; i < 24; ++i) rig.Advance(input, kCycle_s);
    const double from_rad_s = rig.truth().output_velocity_rad_s;
    for (int i = 0; i < 24; ++i) rig.Advance(input, kCycle_s);
    const double expected_rad_s2 =
        (100.0 * 0.02 - 100.0 * 2e-5) / (rotor_kg_m2 + (1.0 + share) * p.link.inertia_kg_m2);
    EXPECT_NEAR((rig.truth().output_velocity_rad_s - from_rad_s) / 0.1, expected_rad_s2,
                0.01 * expected_rad_s2)
        << share;
  }
}

TEST(Rig, ValveCompressorAndVentActAfterTheDeadTimeOfTheirRelays) {
  constexpr double kShort_s = 1e-3;
  RigParameters p;
  p.pneumatics.initial_valve_open = false;
  // What is switched, whose pressure shows it, and which way.
  struct Switch {
    bool RigInput::*on;
    double RigTruth::*pressure_bar;
    double sign;
    double delay_s;
  };
  const Switch switches[] = {{&RigInput::valve_open, &RigTruth::chamber_pressure_bar, 1.0,
                              p.pneumatics.valve_relay.on_delay_s},
                             {&RigInput::compressor_on, &RigTruth::reservoir_pressure_bar, 1.0,
                              p.pneumatics.compressor_relay.on_delay_s},
                             {&RigInput::vent_open, &RigTruth::reservoir_pressure_bar, -1.0,
                              p.pneumatics.vent_relay.on_delay_s}};
  for (const Switch& s : switches) {
    Rig rig{p};
    rig.SetPressure(1.0, 4.0);
    RigInput input;
    input.*s.on = true;
    const auto change_bar = [&, from_bar = rig.truth().*s.pressure_bar] {
      return s.sign * (rig.truth().*s.pressure_bar - from_bar);
    };
    const int delay = static_cast<int>(std::lround(s.delay_s / kShort_s));
    for (int i = 0; i < delay - 1; ++i) rig.Advance(input, kShort_s);
    EXPECT_LT(std::abs(change_bar()), 1e-3);  // the link settles, and its chamber with it
    for (int i = 0; i < 300; ++i) rig.Advance(input, kShort_s);
    EXPECT_GT(change_bar(), 0.01);
  }
}

TEST(Rig, AShutChamberLosesItsAirThroughTheSeal) {
  RigParameters p;
  p.pneumatics.initial_valve_open = false;
  const auto after_a_minute_bar = [&p] {
    Rig rig{p};
    for (int i = 0; i < 60 * 240; ++i) rig.Advance(Idle(), kCycle_s);
    return rig.truth().chamber_pressure_bar;
  };
  const double leaking_bar = after_a_minute_bar();
  p.pneumatics.seal_leak.conductance_m3_sPa = 0.0;
  const double tight_bar = after_a_minute_bar();
  EXPECT_LT(leaking_bar, tight_bar - 0.01);
  EXPECT_GT(leaking_bar, 0.5 * tight_bar);  // a seal, not a hole
}

TEST(Rig, CurrentStaysInsideItsLimitWhateverIsAsked) {
  Rig rig{RigParameters{}};
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 100.0};
  for (int i = 0; i < 240; ++i) {
    rig.Advance(input, kCycle_s);
    ASSERT_LE(std::abs(rig.truth().iq_A), 25.1);
  }
}

TEST(Rig, PositionModeHoldsAndReachesAngles) {
  Rig rig{RigParameters{}};
  RigInput input;
  input.valve_open = true;
  for (const double target_rad : {0.5, -0.3}) {
    input.drive = {types::ControlMode::kPosition, 0.0, target_rad * 100.0, 0.0};
    for (int i = 0; i < 480; ++i) rig.Advance(input, kCycle_s);
    EXPECT_NEAR(rig.truth().motor_angle_rad / 100.0, target_rad, 0.002);
    EXPECT_NEAR(rig.truth().output_angle_rad, target_rad, 0.5 * 0.0465 + 0.002);
  }
}

TEST(Rig, EndStopsHoldTheLinkInsideItsTravel) {
  Rig rig{RigParameters{}};
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 0.05};
  for (int i = 0; i < 240 * 5; ++i) {
    rig.Advance(input, kCycle_s);
    ASSERT_LT(std::abs(rig.truth().output_angle_rad), 2.3562 + 0.05);
  }
  EXPECT_NEAR(rig.truth().output_angle_rad, 2.356, 0.01);
}

TEST(Rig, EncodersReadWholeCounts) {
  Rig rig{RigParameters{}};
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 0.03};
  const double count_rad = 2.0 * std::numbers::pi / 16384.0;
  for (int i = 0; i < 240; ++i) {
    rig.Advance(input, kCycle_s);
    const RigReading reading = rig.Read();
    const double motor_counts = reading.motor_angle_rad / count_rad;
    const double output_counts = reading.output_angle_rad / count_rad;
    ASSERT_NEAR(motor_counts, std::round(motor_counts), 1e-6);
    ASSERT_NEAR(output_counts, std::round(output_counts), 1e-6);
    const double pressure_counts = reading.chamber_pressure_bar / (10.0 / 1024.0);
    ASSERT_NEAR(pressure_counts, std::round(pressure_counts), 1e-9);
  }
}

TEST(Rig, NoiseOfTheSensorsIsWhatTheParametersSay) {
  Rig rig{RigParameters{}};
  constexpr int kCount = 20000;
  double current2 = 0.0, force2 = 0.0, pressure = 0.0, pressure2 = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const RigReading r = rig.Read();
    current2 += r.motor_current_A * r.motor_current_A;
    force2 += r.load_force_N * r.load_force_N;
    pressure += r.chamber_pressure_bar;
    pressure2 += (r.chamber_pressure_bar - 4.0) * (r.chamber_pressure_bar - 4.0);
  }
  // 2 %: four standard errors of a standard deviation over 20000 samples.
  EXPECT_NEAR(std::sqrt(current2 / kCount), 0.03, 0.0006);
  EXPECT_NEAR(std::sqrt(force2 / kCount), 0.05, 0.001);
  EXPECT_NEAR(pressure / kCount, 4.0, 0.001);
  const double lsb_bar = 10.0 / 1024.0;
  EXPECT_NEAR(std::sqrt(pressure2 / kCount), std::sqrt(0.006 * 0.006 + lsb_bar * lsb_bar / 12.0),
              5e-4);
}

TEST(Rig, SameSeedGivesTheSameBitsAndAnotherOneOtherNoise) {
  RigParameters p;
  Rig a{p}, b{p};
  p.seed = 2;
  Rig c{p};
  RigInput input;
  input.valve_open = true;
  int different = 0;
  for (int i = 0; i < 480; ++i) {
    input.drive = {types::ControlMode::kTorque, 0.02 * std::sin(0.05 * i)};
    for (Rig* rig : {&a, &b, &c}) rig->Advance(input, kCycle_s);
    const RigReading ra = a.Read(), rb = b.Read(), rc = c.Read();
    ASSERT_EQ(ra.motor_angle_rad, rb.motor_angle_rad);
    ASSERT_EQ(ra.motor_current_A, rb.motor_current_A);
    ASSERT_EQ(ra.load_force_N, rb.load_force_N);
    ASSERT_EQ(ra.chamber_pressure_bar, rb.chamber_pressure_bar);
    different += ra.motor_current_A != rc.motor_current_A;
  }
  EXPECT_GT(different, 470);
  // Torque mode: noise of the sensors does not touch the motion.
  EXPECT_EQ(a.truth().output_angle_rad, c.truth().output_angle_rad);
}

TEST(Rig, ResetRepeatsTheRunBitForBit) {
  Rig rig{RigParameters{}};
  RigInput input;
  input.drive = {types::ControlMode::kTorque, 0.02};
  const auto run = [&] {
    for (int i = 0; i < 240; ++i) rig.Advance(input, kCycle_s);
    return rig.Read();
  };
  const RigReading first = run();
  rig.Reset();
  const RigReading second = run();
  EXPECT_EQ(first.motor_angle_rad, second.motor_angle_rad);
  EXPECT_EQ(first.motor_current_A, second.motor_current_A);
  EXPECT_EQ(first.motor_temperature_degC, second.motor_temperature_degC);
}

TEST(Rig, SpecimensDifferByAtMostTheSpread) {
  RigParameters p;
  p.spread = 0.1;
  const RigParameters a = Specimen(p);
  p.seed = 2;
  const RigParameters b = Specimen(p);
  EXPECT_NE(a.link.gravity_torque_Nm, b.link.gravity_torque_Nm);
  EXPECT_NEAR(a.link.gravity_torque_Nm, 0.58, 0.058);
  EXPECT_NEAR(b.gear.share_drive, 0.77, 0.077);
  EXPECT_EQ(Specimen(a).link.gravity_torque_Nm, a.link.gravity_torque_Nm);  // drawn once
}

TEST(Rig, RefusesParametersItCannotIntegrate) {
  RigParameters p;
  p.step_s = 2e-4;
  EXPECT_THROW(Rig{p}, std::invalid_argument);
  p = {};
  p.gear.contact_stiffness_Nm_rad = 1e9;
  EXPECT_THROW(Rig{p}, std::invalid_argument);
  p = {};
  p.link.inertia_kg_m2 = 0.0;
  EXPECT_THROW(Rig{p}, std::invalid_argument);
  p = {};
  p.pneumatics.displacement_shape = {1.0};
  EXPECT_THROW(Rig{p}, std::invalid_argument);
  p = {};
  p.initial_angle_rad = 3.0;
  EXPECT_THROW(Rig{p}, std::invalid_argument);
}

TEST(Rig, StaysFiniteUnderHardTreatment) {
  RigParameters p;
  for (const EffectInfo& info : UndeclaredEffects()) {
    p.effects.push_back({std::string(info.name), info.largest_size, 0.0});
  }
  Rig rig{p};
  RandomStream random(5, 1);
  RigInput input;
  for (int i = 0; i < 240 * 30; ++i) {
    if (i % 12 == 0) {
      const double pick = random.Uniform();
      input.drive.mode = pick < 0.3   ? types::ControlMode::kTorque
                         : pick < 0.6 ? types::ControlMode::kPosition
                         : pick < 0.9 ? types::ControlMode::kVelocity
                                      : types::ControlMode::kIdle;
      input.drive.torque_Nm = random.Uniform(-0.4, 0.4);
      input.drive.position_rad = random.Uniform(-200.0, 200.0);
      input.drive.velocity_rad_s = random.Uniform(-300.0, 300.0);
      input.hand_force_N = random.Uniform(-100.0, 100.0);
      input.extra_payload_kg = random.Uniform(0.0, 5.0);
      input.valve_open = random.Uniform() < 0.5;
      input.compressor_on = random.Uniform() < 0.5;
      input.vent_open = random.Uniform() < 0.5;
    }
    rig.Advance(input, kCycle_s);
    const RigTruth t = rig.truth();
    ASSERT_TRUE(std::isfinite(t.output_angle_rad) && std::isfinite(t.motor_angle_rad) &&
                std::isfinite(t.chamber_pressure_bar) && std::isfinite(t.iq_A))
        << i;
    ASSERT_LT(std::abs(t.output_angle_rad), 2.7) << i;
    ASSERT_GT(t.chamber_pressure_bar, -1.02) << i;
  }
}

}  // namespace
}  // namespace sinew::surrogate

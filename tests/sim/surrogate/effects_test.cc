// What each undeclared effect does on the rig. undeclared_test.cc has the first six.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "components/base/types/control_mode.h"
#include "sim/surrogate/excitation.h"
#include "sim/surrogate/experiment.h"
#include "sim/surrogate/rig.h"

namespace sinew::surrogate {
namespace {

constexpr double kMechanismStep_s = 1e-4;

Undeclared Only(const std::string& name, double size, double from_s = 0.0) {
  return Undeclared({{name, size, from_s}}, 100.0);
}

// A rig whose sensors neither round nor scatter.
RigParameters Silent() {
  RigParameters p;
  p.sensors.motor_encoder_noise_rad = p.sensors.output_encoder_noise_rad = 0.0;
  p.sensors.current_noise_A = p.sensors.load_cell_noise_N = p.sensors.pressure_noise_bar = 0.0;
  p.sensors.temperature_noise_degC = p.sensors.temperature_step_degC = 0.0;
  p.sensors.encoder_counts = 1 << 28;
  p.sensors.pressure_counts = 1 << 28;
  return p;
}

// The same without friction and air.
RigParameters Bare() {
  RigParameters p = Silent();
  p.link.friction.kinetic_Nm = p.link.friction.rest_growth_Nm = 0.0;
  p.rotor.friction.kinetic_Nm = 0.0;
  p.rotor.viscous_Nm_s_rad = 0.0;
  p.pneumatics.initial_pressure_bar = 0.0;
  p.pneumatics.displacement_m3_rad = 0.0;
  return p;
}

RigParameters With(RigParameters p, const std::string& name, double size) {
  p.effects = {{name, size, 0.0}};
  return p;
}

std::vector<LogRow> Recording(const RigParameters& rig, double seconds = 6.0,
                              const TruthFunction& truth = {}) {
  const Excitation excitation({.duration_s = seconds, .seed = 3});
  RigParameters prepared = rig;
  excitation.Prepare(&prepared);
  return RunExperiment(prepared, {.duration_s = seconds, .seed = 3}, excitation, truth);
}

TEST(Effects, SizeZeroLeavesEveryReadingAsItWas) {
  const std::vector<LogRow> plain = Recording(RigParameters{});
  ASSERT_GT(plain.size(), 100u);
  for (const EffectInfo& info : UndeclaredEffects()) {
    const std::vector<LogRow> rows = Recording(With(RigParameters{}, std::string(info.name), 0.0));
    ASSERT_EQ(rows.size(), plain.size()) << info.name;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      ASSERT_EQ(rows[i].motor_angle_rad, plain[i].motor_angle_rad) << info.name;
      ASSERT_EQ(rows[i].output_angle_rad, plain[i].output_angle_rad) << info.name;
      ASSERT_EQ(rows[i].motor_current_A, plain[i].motor_current_A) << info.name;
      ASSERT_EQ(rows[i].chamber_pressure_bar, plain[i].chamber_pressure_bar) << info.name;
      ASSERT_EQ(rows[i].load_force_N, plain[i].load_force_N) << info.name;
      ASSERT_EQ(rows[i].motor_temperature_degC, plain[i].motor_temperature_degC) << info.name;
    }
  }
}

TEST(Effects, EveryDefaultChangesARecordingAndKeepsItFinite) {
  const std::vector<LogRow> plain = Recording(RigParameters{}, 24.0);
  for (const EffectInfo& info : UndeclaredEffects()) {
    RigParameters rig;
    rig.effects = {*ParseEffect(info.name)};
    const std::vector<LogRow> rows = Recording(rig, 24.0);
    double difference = 0.0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      difference += std::abs(rows[i].output_angle_rad - plain[i].output_angle_rad) +
                    std::abs(rows[i].motor_current_A - plain[i].motor_current_A) +
                    std::abs(rows[i].chamber_pressure_bar - plain[i].chamber_pressure_bar) +
                    std::abs(rows[i].load_force_N - plain[i].load_force_N);
      ASSERT_LT(std::abs(rows[i].output_angle_rad), 2.5) << info.name;
      ASSERT_TRUE(std::isfinite(rows[i].motor_current_A)) << info.name;
    }
    EXPECT_GT(difference, 0.0) << info.name;
  }
}

TEST(Effects, ABentLipDragsMoreOneWay) {
  const Undeclared lip = Only("direction_dependent_coulomb", 0.1);
  EXPECT_DOUBLE_EQ(lip.ExtraFriction_Nm({.output_velocity_rad_s = 0.5}), 0.05);
  EXPECT_DOUBLE_EQ(lip.ExtraFriction_Nm({.output_velocity_rad_s = -0.5}), -0.05);
  EXPECT_EQ(lip.ExtraFriction_Nm({}), 0.0);
}

TEST(Effects, GreaseThinsAsTheMotorWarms) {
  Undeclared grease = Only("temperature_friction", 0.1);
  double before_Nm = 1.0;
  for (double temperature_degC = 5.0; temperature_degC < 90.0; temperature_degC += 5.0) {
    const EffectState state{.output_velocity_rad_s = 1.0,
                            .motor_temperature_degC = temperature_degC};
    const double dry_Nm = grease.ExtraFriction_Nm(state);
    EXPECT_LT(dry_Nm, before_Nm);
    before_Nm = dry_Nm;
    // The viscous part has the same sign as the dry one, against the motion.
    EXPECT_LE(grease.OutputTorque_Nm(state, kMechanismStep_s) * dry_Nm, 0.0);
  }
  EXPECT_EQ(grease.ExtraFriction_Nm({.motor_temperature_degC = 25.0}), 0.0);
}

TEST(Effects, MoreTorquePerAmpereAndLessWhereTheIronSaturates) {
  EXPECT_DOUBLE_EQ(Only("torque_constant_gain", 0.2).TorqueShare(3.0), 1.2);
  const Undeclared iron = Only("torque_constant_saturation", 0.4);
  EXPECT_DOUBLE_EQ(iron.TorqueShare(0.0), 1.0);
  EXPECT_DOUBLE_EQ(iron.TorqueShare(25.0), 0.6);
  EXPECT_DOUBLE_EQ(iron.TorqueShare(-7.0), iron.TorqueShare(7.0));
  EXPECT_GT(iron.TorqueShare(7.0), iron.TorqueShare(14.0));
}

TEST(Effects, AnOffsetOfTheCurrentIsLoggedAndMissingInTheWindings) {
  Rig rig(With(Silent(), "current_offset", 0.5));
  RigInput input;
  input.drive = {.mode = types::ControlMode::kTorque, .torque_Nm = 0.0};
  rig.Advance(input, 0.2);
  EXPECT_NEAR(rig.truth().iq_A, -0.5, 0.01);
  EXPECT_NEAR(rig.Read().motor_current_A, 0.0, 0.01);
}

TEST(Effects, AnOvalWheelPushesTwiceATurnWithoutAMean) {
  Undeclared wheel = Only("gear_eccentricity", 0.1);
  double sum = 0.0, largest_Nm = 0.0, second = 0.0;
  constexpr int kPlaces = 720;
  for (int i = 0; i < kPlaces; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kPlaces;
    const double torque_Nm =
        wheel.OutputTorque_Nm({.output_angle_rad = angle_rad}, kMechanismStep_s);
    sum += torque_Nm;
    second += torque_Nm * std::sin(2.0 * (angle_rad - 0.5));
    largest_Nm = std::max(largest_Nm, std::abs(torque_Nm));
  }
  EXPECT_NEAR(sum / kPlaces, 0.0, 1e-6);
  EXPECT_NEAR(largest_Nm, 0.1, 1e-6);
  EXPECT_GT(std::abs(2.0 * second / kPlaces), 0.09);
}

TEST(Effects, AMagnetOffTheAxisErrsOncePerTurn) {
  const Undeclared magnet = Only("encoder_eccentricity", 0.01);
  double first = 0.0, worst_rad = 0.0;
  constexpr int kPlaces = 360;
  for (int i = 0; i < kPlaces; ++i) {
    const double angle_rad = 2.0 * std::numbers::pi * i / kPlaces;
    const double error_rad = magnet.OutputEncoder_rad(angle_rad) - angle_rad;
    first += error_rad * std::sin(angle_rad + 0.9);
    worst_rad = std::max(worst_rad, std::abs(error_rad));
  }
  EXPECT_NEAR(2.0 * first / kPlaces, 0.01, 1e-4);
  EXPECT_LT(worst_rad, 0.0102);
}

TEST(Effects, WornTeethLeaveMorePlay) {
  const auto play_rad = [](double worn_rad) {
    Rig rig(With(Bare(), "backlash_width", worn_rad));
    RigInput input;
    double twist_rad[2];
    for (int side = 0; side < 2; ++side) {
      input.drive = {.mode = types::ControlMode::kPosition, .position_rad = 0.0};
      input.hand_force_N = side == 0 ? 10.0 : -10.0;
      rig.Advance(input, 6.0);
      const RigTruth truth = rig.truth();
      twist_rad[side] = truth.motor_angle_rad / 100.0 - truth.output_angle_rad;
    }
    return std::abs(twist_rad[1] - twist_rad[0]);
  };
  EXPECT_NEAR(play_rad(0.01) - play_rad(0.0), 0.01, 1e-4);
}

TEST(Effects, AShaftTwistsUnderTheToothTorque) {
  Rig rig(With(Bare(), "gear_compliance", 2e-3));
  RigInput input;
  input.drive = {.mode = types::ControlMode::kPosition, .position_rad = 0.0};
  input.hand_force_N = 10.0;
  rig.Advance(input, 8.0);
  const RigTruth truth = rig.truth();
  const double twist_rad = truth.motor_angle_rad / 100.0 - truth.output_angle_rad;
  const double half_play_rad = 0.5 * rig.parameters().gear.play_rad;
  EXPECT_NEAR(twist_rad - half_play_rad, truth.tooth_torque_Nm * (2e-3 + 1.0 / 2e4), 2e-5);
  EXPECT_GT(truth.tooth_torque_Nm, 3.0);
}

TEST(Effects, AFlexibleLinkCarriesTheSameWeightAndSwings) {
  // Standing still the teeth carry all of it; kicked, the outer part rings at its own frequency.
  RigParameters p = With(Bare(), "flexible_link", 0.1);
  p.rotor_locked = true;
  Rig rig(p);
  rig.Advance(RigInput{}, 8.0);
  EXPECT_NEAR(rig.truth().tooth_torque_Nm, 0.58, 5e-3);
  RigInput push;
  push.hand_force_N = 5.0;
  rig.Advance(push, 0.002);
  double smallest_Nm = 1.0, largest_Nm = 0.0;
  for (int i = 0; i < 300; ++i) {
    rig.Advance(push, 0.001);
    smallest_Nm = std::min(smallest_Nm, rig.truth().tooth_torque_Nm);
    largest_Nm = std::max(largest_Nm, rig.truth().tooth_torque_Nm);
  }
  // A step of 1.5 N m overshoots on a spring.
  EXPECT_GT(largest_Nm, 0.58 + 1.5 + 0.3);
}

TEST(Effects, TelegramsComeLate) {
  // Angles of the row are those that the prompt rig had 10 ms before.
  const auto at = [](double late_s, double until_s) {
    Rig rig(With(Silent(), "transport_delay", late_s));
    RigInput input;
    input.drive = {.mode = types::ControlMode::kTorque, .torque_Nm = 0.05};
    rig.Advance(input, until_s);
    return rig.Read();
  };
  const RigReading late = at(0.01, 0.3), prompt = at(0.0, 0.29);
  EXPECT_NEAR(late.motor_angle_rad, prompt.motor_angle_rad, 0.05);  // 2 steps
  EXPECT_NEAR(late.output_angle_rad, prompt.output_angle_rad, 5e-4);
  EXPECT_GT(std::abs(at(0.0, 0.3).motor_angle_rad - prompt.motor_angle_rad), 1.0);
}

TEST(Effects, ARingHasInertiaAndNoWeight) {
  RigParameters p = Bare();
  p.gear.play_rad = 1e3;  // the link swings by itself
  p.link.end_stop_rad = 100.0;
  p.pneumatics.displacement_shape = {1.0, 1.0};
  p.initial_angle_rad = -0.5 * std::numbers::pi + 0.05;
  const auto quarter_s = [&](double ring_kg_m2) {
    Rig rig(With(p, "link_inertia", ring_kg_m2));
    double seconds = 0.0;
    while (rig.truth().output_angle_rad > -0.5 * std::numbers::pi && seconds < 5.0) {
      rig.Advance(RigInput{}, 1e-3);
      seconds += 1e-3;
    }
    return seconds;
  };
  EXPECT_NEAR(quarter_s(0.0), 0.25 * 2.0 * std::numbers::pi * std::sqrt(0.019 / 0.58), 3e-3);
  EXPECT_NEAR(quarter_s(0.02), 0.25 * 2.0 * std::numbers::pi * std::sqrt(0.039 / 0.58), 3e-3);
}

TEST(Effects, AStepOfPayloadAndABumpComeAtTheirTimes) {
  Undeclared step = Only("payload_step", 0.3, 5.0);
  EXPECT_EQ(step.payload_kg(), 0.0);
  step.SetTime(5.0);
  EXPECT_EQ(step.payload_kg(), 0.3);
  Undeclared bump = Only("external_bump", 8.0, 2.0);
  double impulse_N_s = 0.0;
  for (double time_s = 0.0; time_s < 10.0; time_s += 0.01) {
    bump.SetTime(time_s);
    if (time_s < 2.0 || time_s > 2.81) {
      EXPECT_EQ(bump.Bump_N(), 0.0) << time_s;
    }
    EXPECT_LE(bump.Bump_N(), 8.0);
    impulse_N_s += 0.01 * bump.Bump_N();
  }
  EXPECT_NEAR(impulse_N_s, 8.0 * 0.415, 0.3);
  EXPECT_EQ(ParseEffect("external_bump")->from_s, 20.0);
  EXPECT_EQ(ParseEffect("payload_step=0.2@7")->from_s, 7.0);
}

TEST(Effects, ATiltTurnsGravity) {
  EXPECT_DOUBLE_EQ(Only("gravity_phase", 0.1).Tilt_rad(), 0.1);
  Undeclared slow = Only("slow_tilt", 0.1);
  EXPECT_EQ(slow.Tilt_rad(), 0.0);
  slow.SetTime(30.0);
  EXPECT_DOUBLE_EQ(slow.Tilt_rad(), 0.05);
  RigParameters p = With(Bare(), "gravity_phase", 0.3);
  p.rotor_locked = true;
  Rig rig(p);
  rig.Advance(RigInput{}, 8.0);
  EXPECT_NEAR(rig.truth().tooth_torque_Nm, 0.58 * std::cos(rig.truth().output_angle_rad + 0.3),
              2e-3);
}

TEST(Effects, TheLoadCellReadsWrong) {
  EXPECT_DOUBLE_EQ(Only("load_cell_gain", 0.1).LoadCell_N(10.0, 0.5), 11.0);
  const Undeclared turned = Only("load_cell_misalignment", 0.2);
  EXPECT_NEAR(turned.LoadCell_N(10.0, 0.0), 10.0 * std::cos(0.2), 1e-12);
  // Raised, it sees less of a vertical push than the link does; lowered, more.
  EXPECT_LT(turned.LoadCell_N(10.0, 0.5), 9.0);
  EXPECT_GT(turned.LoadCell_N(10.0, -0.5), 10.0);
}

TEST(Effects, ThePressureSensorReadsWrong) {
  const auto seen_bar = [](const std::string& name, double size) {
    RigParameters p = With(Silent(), name, size);
    p.rotor_locked = true;
    p.pneumatics.initial_pressure_bar = 3.0;
    Rig rig(p);
    rig.Advance(RigInput{}, 0.05);
    return rig.Read().chamber_pressure_bar - rig.truth().chamber_pressure_bar;
  };
  EXPECT_NEAR(seen_bar("pressure_offset", 0.2), 0.2, 1e-6);
  EXPECT_NEAR(seen_bar("pressure_gain", 0.1), 0.3, 1e-3);
  // A vented chamber: the reading stays behind by the lag times the rate.
  RigParameters p = With(Silent(), "pressure_lag", 0.2);
  p.rotor_locked = true;
  Rig rig(p);
  RigInput vent;
  vent.valve_open = vent.vent_open = true;
  rig.Advance(vent, 3.0);
  const double before_bar = rig.truth().chamber_pressure_bar;
  rig.Advance(vent, 0.2);
  const double now_bar = rig.truth().chamber_pressure_bar;
  EXPECT_NEAR(rig.Read().chamber_pressure_bar, before_bar, 0.05 * (before_bar - now_bar));
}

TEST(Effects, TheChamberLosesAirKeepsHeatAndItsValveIsLate) {
  RigParameters p = Silent();
  p.rotor_locked = true;
  p.pneumatics.initial_valve_open = false;
  p.pneumatics.dead_volume_m3 = 1e-4;
  const auto after_bar = [&](const std::string& name, double size, const RigInput& input,
                             double seconds) {
    Rig rig(With(p, name, size));
    rig.SetPressure(5.0, 2.0);
    rig.Advance(input, seconds);
    return rig.truth().chamber_pressure_bar;
  };
  EXPECT_LT(after_bar("leak", 1e-11, {}, 5.0), after_bar("leak", 0.0, {}, 5.0) - 0.05);
  RigInput open;
  open.valve_open = true;
  const double prompt_bar = after_bar("valve_dead_time", 0.0, open, 0.05);
  EXPECT_LT(prompt_bar, 4.9);
  EXPECT_GT(after_bar("valve_dead_time", 0.1, open, 0.05), 4.99);
  EXPECT_NEAR(after_bar("valve_dead_time", 0.1, open, 0.15), prompt_bar, 0.02);

  // Squeezed and held: with still air along the wall the warmth stays for long.
  Vessel vessel(1e-4, 4e5, 296.15, 10.0);
  const auto warmth_K = [&](double resistance_K_W) {
    Vessel squeezed = vessel;
    squeezed.SetVolume(0.9e-4);
    for (int i = 0; i < 1000; ++i) squeezed.ExchangeHeat(296.15, 1e-3, resistance_K_W);
    return squeezed.temperature_K() - 296.15;
  };
  EXPECT_LT(warmth_K(0.0), 0.01);
  EXPECT_GT(warmth_K(20.0), 5.0);
}

TEST(Effects, GreaseBendsBeforeItSlidesAndTakesEnergy) {
  Undeclared bearing = Only("presliding", 0.1);
  const auto move = [&](double velocity_rad_s, double angle_rad) {
    double torque_Nm = 0.0;
    for (double moved = 0.0; moved < angle_rad;
         moved += std::abs(velocity_rad_s) * kMechanismStep_s) {
      torque_Nm =
          bearing.OutputTorque_Nm({.output_velocity_rad_s = velocity_rad_s}, kMechanismStep_s);
    }
    return torque_Nm;
  };
  EXPECT_NEAR(move(0.5, 0.3), -0.1, 1e-9);
  const double part_Nm = move(-0.5, 0.04);
  EXPECT_GT(part_Nm, -0.1);
  EXPECT_LT(part_Nm, 0.1);
  EXPECT_NEAR(move(-0.5, 0.3), 0.1, 1e-9);
}

TEST(Effects, AVaneFoldsAtLowPressureOnly) {
  const Undeclared vane = Only("stiffness_collapse", 0.4);
  EXPECT_DOUBLE_EQ(vane.PneumaticShare(0.0), 0.6);
  EXPECT_DOUBLE_EQ(vane.PneumaticShare(3.0), 1.0);
  EXPECT_LT(vane.PneumaticShare(1.0), vane.PneumaticShare(1.8));
}

TEST(Effects, ACableDragsPastAnAngleOnly) {
  Undeclared cable = Only("cable_drag", 0.2);
  const auto drag_Nm = [&](double angle_rad) {
    double torque_Nm = 0.0;
    for (int i = 0; i < 5000; ++i) {
      torque_Nm = cable.OutputTorque_Nm(
          {.output_velocity_rad_s = 0.5, .output_angle_rad = angle_rad}, kMechanismStep_s);
    }
    return torque_Nm;
  };
  EXPECT_EQ(drag_Nm(0.2), 0.0);
  EXPECT_NEAR(drag_Nm(0.7), -0.2, 1e-9);
}

TEST(Effects, ABadToothIsFeltOncePerTurnOfTheFirstWheel) {
  const Undeclared tooth = Only("bad_tooth", 0.01);
  int felt = 0;
  bool inside = false;
  for (double motor_rad = 0.0; motor_rad < 30.0 * 2.0 * std::numbers::pi; motor_rad += 0.02) {
    const bool now = tooth.RotorTorque_Nm({.motor_angle_rad = motor_rad}) != 0.0;
    if (now && !inside) ++felt;
    inside = now;
  }
  EXPECT_EQ(felt, 3);
}

TEST(Effects, ASaggingSupplyReportsTheTrueCurrent) {
  Undeclared supply = Only("supply_sag", 0.9);
  supply.SetTime(4.0);
  EXPECT_NEAR(supply.SupplyShare(), 0.1, 1e-12);
  supply.SetTime(6.0);
  EXPECT_DOUBLE_EQ(supply.SupplyShare(), 1.0);
  double most_missing_A = 0.0;
  RigParameters p = With(Silent(), "supply_sag", 0.97);
  const std::vector<LogRow> sagging = Recording(p, 12.0);
  const std::vector<LogRow> plain = Recording(Silent(), 12.0);
  for (std::size_t i = 0; i < plain.size(); ++i) {
    most_missing_A =
        std::max(most_missing_A, plain[i].motor_current_A - sagging[i].motor_current_A);
  }
  EXPECT_GT(most_missing_A, 0.2);
}

TEST(Effects, AMagnetSlipsWhenTheLinkGoesUpFast) {
  Undeclared magnet = Only("slipping_magnet", 0.002);
  for (int swing = 0; swing < 4; ++swing) {
    magnet.MoveMagnet(-0.9, kMechanismStep_s);
    magnet.MoveMagnet(0.5, kMechanismStep_s);
    EXPECT_NEAR(magnet.OutputEncoder_rad(1.0), 1.0 - 0.002 * swing, 1e-12);
    magnet.MoveMagnet(0.9, kMechanismStep_s);
    magnet.MoveMagnet(0.9, kMechanismStep_s);
  }
}

}  // namespace
}  // namespace sinew::surrogate

// The kinematic balance: what the simulation plays, regression gets back from the two encoders.
#include "components/model/identify/kinematic.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "components/base/types/control_mode.h"
#include "components/model/trace/close_loop.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/whitened_fit.h"
#include "sim/plant/single_joint.h"

namespace sinew::plant {
namespace {

using actuator::JointModel;
using effects::Balance;
using types::Signal;

constexpr double kPlay_rad = 0.046;
constexpr double kCounts = 16384.0;

JointModel Rig() {
  JointModel model;
  model.name = "joint";
  model.constants = {.gear_ratio = 100.0,
                     .link_length_m = 0.3,
                     .torque_constant_Nm_A = 0.0159155,
                     .encoder_counts_per_turn = kCounts};
  model.backlash_rad = kPlay_rad;
  const auto add = [&](const char* effect, std::vector<double> values, bool fixed = false) {
    model.terms.push_back(actuator::MakeTerm(effect, model.constants));
    for (std::size_t i = 0; i < values.size(); ++i) {
      actuator::ParameterValue& value = model.terms.back().linear[i];
      value.value = values[i];
      value.tolerance = fixed ? 0.0 : 0.15;
      value.fixed = fixed;
    }
  };
  add("drive_current", {0.77}, true);
  add("rotor_inertia", {0.115});
  add("link_inertia", {0.02});
  add("motor_viscous", {0.31});
  add("coulomb", {0.22});
  add("gravity", {0.6});
  add("load_force", {1.0}, true);
  add("encoder_difference", {1.0}, true);
  add("free_play", {kPlay_rad, 1e-5}, true);
  add("encoder_offset", {0.0});
  return model;
}

JointModel With(const char* effect, std::vector<double> values, std::vector<double> psi = {}) {
  JointModel model = Rig();
  model.terms.push_back(actuator::MakeTerm(effect, model.constants, Balance::kKinematic));
  for (std::size_t i = 0; i < values.size(); ++i) model.terms.back().linear[i].value = values[i];
  for (std::size_t i = 0; i < psi.size(); ++i) model.terms.back().nonlinear[i].value = psi[i];
  return model;
}

// 80 Hz of a joint that follows sines while a hand presses and pulls; encoders of 14 bits with
// noise, the middle of the play 0.003 rad off.
types::Run Record(const JointModel& truth, std::uint64_t seed, double duration_s = 60.0) {
  SingleJoint joint(truth, {.contact_stiffness_Nm_rad = 1e5});
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> phase(0.0, 2.0 * M_PI);
  const double a = phase(random), b = phase(random), c = phase(random);
  const auto count = static_cast<Eigen::Index>(duration_s * 80.0);
  Eigen::VectorXd motor(count), output(count), current(count), force(count);
  types::Run run;
  run.name = "run_" + std::to_string(seed);
  run.content_hash = run.name;
  run.time_s.resize(count);
  const double lsb = 2.0 * M_PI / kCounts;
  const auto read = [&](double angle) {
    return lsb * std::round((angle + 1.5e-4 * normal(random)) / lsb);
  };
  constexpr double kStep_s = 1.0 / 16000.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int k = 0; k < 200; ++k) {
      const double t = (static_cast<double>(i) * 200.0 + k) * kStep_s;
      const double hand = 12.0 * std::sin(2.0 * M_PI * 0.23 * t + c) * std::sin(0.9 * t);
      joint.plant().SetLoad(hand, 0.0);
      joint.plant().SetCommand({.mode = types::ControlMode::kPosition,
                                .position_rad = 0.5 * std::sin(2.0 * M_PI * 0.31 * t + a) +
                                                0.25 * std::sin(2.0 * M_PI * 0.73 * t + b)});
      joint.Step(kStep_s);
      force[i] = hand;
    }
    run.time_s[i] = static_cast<double>(i + 1) / 80.0;
    motor[i] = read(joint.plant().motor_position_rad()) + 0.3;
    output[i] = read(joint.position_rad() + joint.plant().encoder_error_rad());
    current[i] = joint.plant().drive_input() + 0.03 * normal(random);
  }
  run.signals = {{Signal::kMotorPosition, motor},
                 {Signal::kPosition, output},
                 {Signal::kMotorCurrent, current},
                 {Signal::kLoadForce, force}};
  return run;
}

identify::ProcessingOptions Processing() {
  return {.state_cutoff_Hz = 20.0,
          .parallel_cutoff_Hz = 5.0,
          .rest_velocity = 0.04,
          .settle_distance = 0.005};
}

trace::TraceResult TraceOf(const JointModel& truth, std::uint64_t seed,
                           const JointModel& declared = Rig()) {
  return trace::CloseLoop({Record(truth, seed), Record(truth, seed + 1)}, {Record(truth, seed + 2)},
                          declared, 0.25, {})
      .trace;
}

// The teeth's side as the simulation knows it, at every row that is used.
TEST(KinematicStates, NameTheSideThatTheTeethTouchOn) {
  const JointModel truth = Rig();
  const types::Run run = Record(truth, 5);
  const identify::StateSet states = identify::MakeKinematicStates({run}, truth, Processing());
  const identify::StateSegment& segment = states.segments.front();
  int used = 0, wrong = 0;
  for (std::size_t i = 0; i < segment.samples.size(); ++i) {
    if (!segment.usable[i]) continue;
    ++used;
    const double difference = segment.drive_input[static_cast<Eigen::Index>(i)] - 0.003;
    EXPECT_NE(segment.samples[i].tooth_side, 0.0);
    wrong += difference * segment.samples[i].tooth_side > 0.45 * kPlay_rad ? 0 : 1;
  }
  EXPECT_GT(used, 1000);
  EXPECT_LE(wrong, used / 500);
}

struct Hidden {
  const char* effect;
  std::vector<double> values;
  std::vector<double> psi;
};

class KinematicEffect : public ::testing::TestWithParam<Hidden> {};

// Simulation and regression agree: found first, and its parameters within 10 % of what was played,
// which is several of their standard errors.
TEST_P(KinematicEffect, IsFoundWithItsParameters) {
  const trace::TraceResult result =
      TraceOf(With(GetParam().effect, GetParam().values, GetParam().psi), 10);
  ASSERT_EQ(result.verdict, trace::Verdict::kEffect);
  const trace::FoundEffect& found = result.effects.front();
  EXPECT_EQ(found.name, GetParam().effect);
  EXPECT_EQ(found.balance, Balance::kKinematic);
  EXPECT_LT(found.held_out_after, found.held_out_before);
  const actuator::Term& term = result.corrected.terms[static_cast<std::size_t>(found.term)];
  double played = 0.0, fitted = 0.0;  // amplitudes: the motor's zero turns sine and cosine
  for (std::size_t i = 0; i < GetParam().values.size(); ++i) {
    played = std::hypot(played, GetParam().values[i]);
    fitted = std::hypot(fitted, term.linear[i].value);
  }
  EXPECT_NEAR(fitted, played, 0.1 * played);
  for (std::size_t i = 0; i < GetParam().psi.size(); ++i) {
    EXPECT_EQ(term.nonlinear[i].value, GetParam().psi[i]);
  }
  ASSERT_EQ(result.balances.size(), 1u);
  EXPECT_EQ(result.balances[0].unit, "rad");
  EXPECT_LT(result.balances[0].after_held_out.rms, result.balances[0].before_held_out.rms);
}

INSTANTIATE_TEST_SUITE_P(Kinematic, KinematicEffect,
                         ::testing::Values(Hidden{"backlash_width", {0.002}, {}},
                                           Hidden{"encoder_eccentricity", {6e-4, -4e-4}, {100.0}}),
                         [](const auto& which) {
                           return std::string(which.param.effect) +
                                  (which.param.psi.empty()
                                       ? ""
                                       : "_" +
                                             std::to_string(static_cast<int>(which.param.psi[0])));
                         });

TEST(KinematicBalance, WithoutAnEffectNoneIsFoundAndTheOffsetIsFitted) {
  const trace::TraceResult result = TraceOf(Rig(), 20);
  EXPECT_EQ(result.verdict, trace::Verdict::kNone);
  EXPECT_NEAR(result.corrected.Parameter("encoder_offset", "offset"), 0.003, 1e-4);
}

// A motor's encoder that counts from where it was switched on, or is homed anew: its zero is that
// of a recording.
TEST(KinematicBalance, AZeroOfItsOwnInEveryRecordingIsNoEffectAndHidesNone) {
  const double zeros[] = {0.02, -0.05, 0.08};
  const auto trace_of = [&](const JointModel& truth) {
    std::vector<types::Run> runs;
    for (std::uint64_t k = 0; k < 3; ++k) {
      runs.push_back(Record(truth, 40 + k));
      runs.back().signals.at(Signal::kMotorPosition).array() +=
          Rig().constants.gear_ratio * zeros[k];
    }
    return trace::CloseLoop({runs[0], runs[1]}, {runs[2]}, Rig(), 0.25, {}).trace;
  };
  const trace::TraceResult plain = trace_of(Rig());
  EXPECT_EQ(plain.verdict, trace::Verdict::kNone);
  // Errors are those of changes within a recording: far below the zeros.
  ASSERT_EQ(plain.balances.size(), 1u);
  EXPECT_LT(plain.balances[0].after_held_out.rms, 1e-3);
  // The offset is that of the training recordings, no better known than they differ.
  const actuator::Term& offset =
      plain.corrected.terms[static_cast<std::size_t>(plain.corrected.Find("encoder_offset"))];
  EXPECT_NEAR(offset.linear[0].value, 0.003 + 0.5 * (zeros[0] + zeros[1]), 1e-3);
  EXPECT_GT(offset.linear[0].half_width_95.value(), 0.035);

  const trace::TraceResult wider = trace_of(With("backlash_width", {0.002}));
  ASSERT_EQ(wider.effects.size(), 1u);
  EXPECT_EQ(wider.effects.front().name, "backlash_width");
}

// What is added to a declared compliance may be negative: their sum may not.
TEST(KinematicBalance, TeethStifferThanDeclaredAreAComplianceBelowZero) {
  constexpr double kDeclared_rad_Nm = 6e-4, kTrue_rad_Nm = 1e-5;
  JointModel softer = Rig();
  actuator::Term& play = softer.terms[static_cast<std::size_t>(softer.Find("free_play"))];
  play.linear[1].value = kDeclared_rad_Nm;
  const trace::TraceResult result = TraceOf(Rig(), 30, softer);
  ASSERT_EQ(result.effects.size(), 1u);
  EXPECT_EQ(result.effects.front().name, "gear_compliance");
  const double sum = kDeclared_rad_Nm + result.corrected.Parameter("gear_compliance", "compliance");
  EXPECT_GE(sum, 0.0);
  EXPECT_NEAR(sum, kTrue_rad_Nm, 0.1 * kDeclared_rad_Nm);
}

// The torque that twists the teeth is scaled as the drive is: what that makes of a declared
// compliance is an imperfection and no gear of another compliance.
TEST(KinematicBalance, ADeclaredComplianceIsAsUncertainAsTheDrivesScale) {
  constexpr double kCompliance_rad_Nm = 6e-4;
  const types::Run run = Record(Rig(), 40, 20.0);
  const auto spread = [&](const actuator::ParameterValue& drive) {
    JointModel model = Rig();
    model.terms.front().linear[0] = drive;
    model.terms[static_cast<std::size_t>(model.Find("free_play"))].linear[1].value =
        kCompliance_rad_Nm;
    identify::StateSet states = identify::MakeKinematicStates({run}, model, Processing());
    const identify::ProcessingOptions options = identify::Unfiltered(Processing(), states.rate_Hz);
    const identify::Design design(std::move(states), options);
    model.balance = Balance::kKinematic;
    trace::Likelihood likelihood;
    likelihood.used = trace::MakeUsedRows(design, 20);
    const trace::Nuisances nuisances = trace::MakeNuisances(design, likelihood, model);
    const auto at = std::find(nuisances.names.begin(), nuisances.names.end(), "gear_compliance");
    return nuisances.spread[at - nuisances.names.begin()];
  };
  actuator::ParameterValue drive = Rig().terms.front().linear[0];
  const double exact = spread(drive);
  drive.fixed = false;
  drive.tolerance = 0.15;
  const double error = actuator::RelativeSpread(drive) * kCompliance_rad_Nm;
  ASSERT_GT(error, 0.0);
  EXPECT_NEAR(spread(drive), std::hypot(exact, error), 0.02 * error);
}

TEST(KinematicBalance, WithoutTheMotorsAngleSaysWhyNothingIsSeen) {
  const auto blind = [](std::uint64_t seed) {
    types::Run run = Record(Rig(), seed, 20.0);
    run.signals.erase(Signal::kMotorPosition);
    return run;
  };
  JointModel model = Rig();
  model.backlash_rad = 0.0;  // the motor's motion is then known from the output's
  const trace::TraceResult result =
      trace::CloseLoop({blind(1), blind(2)}, {blind(3)}, model, 0.25, {}).trace;
  ASSERT_EQ(result.balances.size(), 1u);
  EXPECT_NE(result.balances[0].unseen.find("no motor angle"), std::string::npos);
  bool listed = false;
  for (const trace::NotExcited& hidden : result.not_excited) {
    listed = listed || (hidden.effect == "backlash_width" &&
                        hidden.reason.find("no motor angle") != std::string::npos);
  }
  EXPECT_TRUE(listed);
}

}  // namespace
}  // namespace sinew::plant

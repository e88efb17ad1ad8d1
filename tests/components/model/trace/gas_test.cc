// The gas balance: a chamber that is compressed, filled and vented by the formulas of the
// catalogue, read by a sensor of ten bits, and what the trace gets back.
#include "components/model/identify/gas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "components/model/trace/balances.h"
#include "components/model/trace/close_loop.h"

namespace sinew::trace {
namespace {

using actuator::JointModel;
using effects::Balance;
using types::Signal;

constexpr double kGasRate_Hz = 80.0;

JointModel GasRig() {
  JointModel model;
  model.name = "joint";
  model.constants = {.gear_ratio = 100.0,
                     .link_length_m = 0.3,
                     .torque_constant_Nm_A = 0.0159155,
                     .gas_volume_m3 = 0.002};
  const auto add = [&](const char* effect, double value, bool fixed) {
    model.terms.push_back(actuator::MakeTerm(effect, model.constants));
    model.terms.back().linear[0].value = value;
    model.terms.back().linear[0].tolerance = fixed ? 0.0 : 0.15;
    model.terms.back().linear[0].fixed = fixed;
  };
  add("drive_current", 0.77, true);
  add("inertia", 0.14, false);
  add("viscous", 0.31, false);
  add("coulomb", 0.22, false);
  add("gravity", 0.6, false);
  add("pneumatic_torque", 0.36, false);
  add("pneumatic_stiffness", 4.0, false);
  model.terms.back().nonlinear[0].value = 0.15;
  add("chamber_pressure", 1.0, true);
  add("gas_compression", 1.0, false);
  add("valve_flow", 1.0, true);
  return model;
}

JointModel WithGas(const char* effect, std::vector<double> values, std::vector<double> psi = {}) {
  JointModel model = GasRig();
  model.terms.push_back(actuator::MakeTerm(effect, model.constants, Balance::kGas));
  for (std::size_t i = 0; i < values.size(); ++i) model.terms.back().linear[i].value = values[i];
  for (std::size_t i = 0; i < psi.size(); ++i) model.terms.back().nonlinear[i].value = psi[i];
  return model;
}

// A joint on sines; every 10 s the valve opens for 2 s toward another pressure. late_s: flow after
// the command.
types::Run RecordGas(const JointModel& truth, std::uint64_t seed, double late_s = 0.0) {
  constexpr int kSteps = 25;
  constexpr double kStep_s = 1.0 / (kGasRate_Hz * kSteps);
  constexpr double kToTarget_s = 0.35;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  JointModel motion = truth;
  motion.balance = Balance::kMotion;
  double phases[4], targets[12];
  for (double& phase : phases) phase = 2.0 * M_PI * uniform(random);
  for (double& target : targets) target = 1.0 + 4.5 * uniform(random);
  const double jitter_s = uniform(random) / kGasRate_Hz;  // the command falls between two rows
  const auto count = static_cast<Eigen::Index>(80.0 * kGasRate_Hz);
  Eigen::VectorXd position(count), pressure(count), valve(count), current(count);
  types::Run run;
  run.name = "gas_" + std::to_string(seed);
  run.content_hash = run.name;
  run.time_s.resize(count);
  std::vector<double> memory(static_cast<std::size_t>(truth.memory_size()));
  effects::JointSample x;
  x.pressure_bar = 3.0;
  truth.ResetMemory(x, memory);
  JointModel gas = truth;
  gas.balance = Balance::kGas;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int k = 0; k < kSteps; ++k) {
      const double t = (static_cast<double>(i) * kSteps + k) * kStep_s;
      x.time_s = t;
      x.position_rad = x.velocity_rad_s = x.acceleration_rad_s2 = 0.0;
      constexpr double kHz[] = {0.13, 0.41, 0.9, 1.7}, kRad[] = {0.35, 0.2, 0.1, 0.04};
      for (int n = 0; n < 4; ++n) {
        const double w = 2.0 * M_PI * kHz[n];
        x.position_rad += kRad[n] * std::sin(w * t + phases[n]);
        x.velocity_rad_s += kRad[n] * w * std::cos(w * t + phases[n]);
        x.acceleration_rad_s2 -= kRad[n] * w * w * std::sin(w * t + phases[n]);
      }
      const double slope = identify::ChamberSlope_m3_rad(motion, x.position_rad);
      const double at_rest = identify::ChamberSlope_m3_rad(motion, 0.15);
      const double volume =
          truth.constants.gas_volume_m3 + 0.5 * (slope + at_rest) * (x.position_rad - 0.15);
      x.volume_rate_1_s = slope * x.velocity_rad_s / volume;
      const auto in_cycle = [&](double delay) {
        const double since = std::fmod(t - jitter_s - delay - 8.0 + 100.0, 10.0);
        return t - jitter_s - delay >= 8.0 && since < 2.0;
      };
      x.valve_open = in_cycle(0.0);
      const bool flows = in_cycle(late_s) && x.valve_open;
      x.drive_input = 0.0;
      double rate = -gas.Torque(effects::Role::kPassive, x, memory);
      if (x.valve_open) {
        rate = flows ? (targets[static_cast<std::size_t>((t - 8.0) / 10.0)] - x.pressure_bar) /
                           kToTarget_s
                     : 0.0;
      }
      x.pressure_rate_bar_s = rate;
      x.pressure_bar += kStep_s * rate;
      truth.Advance(x, kStep_s, memory);
    }
    run.time_s[i] = static_cast<double>(i + 1) / kGasRate_Hz;
    position[i] = x.position_rad + 2e-4 * normal(random);
    constexpr double kLsb_bar = 10.0 / 1024.0;
    pressure[i] = kLsb_bar * std::round((x.pressure_bar + 0.006 * normal(random)) / kLsb_bar);
    valve[i] = x.valve_open ? 1.0 : 0.0;
    current[i] = motion.RequiredDriveInput(x, memory) + 0.03 * normal(random);
  }
  run.signals = {{Signal::kPosition, position},
                 {Signal::kMotorPosition, Eigen::VectorXd(100.0 * position)},
                 {Signal::kChamberPressure, pressure},
                 {Signal::kValveOpen, valve},
                 {Signal::kMotorCurrent, current}};
  return run;
}

TraceResult TraceGas(const JointModel& truth, std::uint64_t seed, double late_s = 0.0) {
  return CloseLoop({RecordGas(truth, seed, late_s), RecordGas(truth, seed + 1, late_s)},
                   {RecordGas(truth, seed + 2, late_s)}, GasRig(), 0.25, {})
      .trace;
}

// Names of what was found in the gas balance.
std::vector<std::string> GasEffects(const TraceResult& result) {
  std::vector<std::string> out;
  for (const FoundEffect& found : result.effects) {
    if (found.balance == Balance::kGas) out.push_back(found.name);
  }
  return out;
}

TEST(GasStates, AreWindowsWithTheValveShutAndAroundItsOpenings) {
  const JointModel truth = GasRig();
  const identify::GasWindows gas = identify::MakeGasStates(
      {RecordGas(truth, 3)}, truth, {.state_cutoff_Hz = 20.0, .rest_velocity = 0.04});
  // Eight openings; one toward nearly the same pressure shows nothing.
  EXPECT_GE(gas.openings, 6);
  EXPECT_LE(gas.openings, 8);
  EXPECT_GE(gas.shut, 8);
  const identify::StateSegment& segment = gas.states.segments.front();
  double longest_s = 0.0, open_s = 0.0;
  for (std::size_t i = 0; i < segment.samples.size(); ++i) {
    if (!segment.usable[i]) continue;
    ASSERT_GE(segment.window[i], 0);
    open_s = segment.samples[i].valve_open ? open_s + segment.period_s : 0.0;
    longest_s = std::max(longest_s, open_s);
  }
  EXPECT_LE(longest_s, identify::kAfterOpening_s + identify::kLongestDeadTime_s + segment.period_s);
}

// K and k1 of the model in bar and m3: 1e-5 (K - k1 (q - q0)).
TEST(ChamberSlope, IsThePneumaticTorquePerPressure) {
  EXPECT_NEAR(identify::ChamberSlope_m3_rad(GasRig(), 0.35), 1e-5 * (0.36 - 4.0 * 0.2), 1e-18);
}

TEST(GasBalance, WithoutAnEffectNoneIsFoundAndTheVolumeIs) {
  JointModel truth = GasRig();
  truth.terms[static_cast<std::size_t>(truth.Find("gas_compression"))].linear[0].value = 1.1;
  const TraceResult result = TraceGas(truth, 20);
  EXPECT_EQ(result.verdict, Verdict::kNone);
  ASSERT_EQ(result.balances.size(), 1u);
  EXPECT_EQ(result.balances[0].unit, "bar");
  EXPECT_EQ(result.balances[0].unseen, "");
  EXPECT_NEAR(result.corrected.Parameter("gas_compression", "share"), 1.1, 0.04);
}

// What the chamber's balance leaves says nothing about the encoders.
TEST(GasBalance, LeavesTheEncodersOffsetAsItIs) {
  JointModel model = GasRig();
  model.terms.push_back(actuator::MakeTerm("encoder_offset", model.constants));
  model.terms.back().linear[0].value = 0.003;
  const TraceResult result = TraceBalance(
      Balance::kGas, {RecordGas(model, 50), RecordGas(model, 51)}, {RecordGas(model, 52)}, model,
      {.state_cutoff_Hz = 20.0, .rest_velocity = 0.04}, {});
  EXPECT_EQ(result.unseen, "");
  for (const JointModel& fitted : {result.declared, result.corrected}) {
    EXPECT_EQ(fitted.Parameter("encoder_offset", "offset"), 0.003);
  }
}

struct HiddenGas {
  const char* name;
  const char* effect;
  std::vector<double> values, psi;
};

class GasEffect : public ::testing::TestWithParam<HiddenGas> {};

// Within a fifth: the noise of ten bits is a good part of what these move.
TEST_P(GasEffect, IsFoundWithItsParameters) {
  const TraceResult result =
      TraceGas(WithGas(GetParam().effect, GetParam().values, GetParam().psi), 30);
  ASSERT_EQ(GasEffects(result), std::vector<std::string>{GetParam().effect});
  const FoundEffect& found = *std::find_if(
      result.effects.begin(), result.effects.end(),
      [](const FoundEffect& effect) { return effect.balance == effects::Balance::kGas; });
  EXPECT_LT(found.held_out_after, found.held_out_before);
  const actuator::Term& term = result.corrected.terms[static_cast<std::size_t>(found.term)];
  for (std::size_t i = 0; i < GetParam().values.size(); ++i) {
    EXPECT_NEAR(term.linear[i].value, GetParam().values[i], 0.2 * GetParam().values[i]);
  }
}

INSTANTIATE_TEST_SUITE_P(Gas, GasEffect,
                         ::testing::Values(HiddenGas{"leak", "leak", {2e-3}, {0.75}},
                                           HiddenGas{
                                               "heat", "gas_heat_exchange", {1.0, 1.0}, {1.0}}),
                         [](const auto& which) { return which.param.name; });

// 60 ms within two samples: the curve of the flow and its instant are fitted to the same few rows.
TEST(GasBalance, AValveThatOpensLateIsFound) {
  const TraceResult result = TraceGas(GasRig(), 40, 0.06);
  ASSERT_EQ(GasEffects(result), std::vector<std::string>{"valve_dead_time"});
  EXPECT_NEAR(result.corrected.Parameter("valve_dead_time", "dead_time"), 0.06, 2.0 / kGasRate_Hz);
}

TEST(GasBalance, AnOpeningOfAFewMillisecondsIsNoDeadTime) {
  EXPECT_TRUE(GasEffects(TraceGas(GasRig(), 41, 0.015)).empty());
}

TEST(GasBalance, AValveWithoutASignalLeavesNothingToSee) {
  const auto blind = [](std::uint64_t seed) {
    types::Run run = RecordGas(GasRig(), seed);
    run.signals.erase(Signal::kValveOpen);
    return run;
  };
  const TraceResult result = CloseLoop({blind(1), blind(2)}, {blind(3)}, GasRig(), 0.25, {}).trace;
  ASSERT_EQ(result.balances.size(), 1u);
  EXPECT_NE(result.balances[0].unseen.find("when the valve was open"), std::string::npos);
}

TEST(GasBalance, TheDocumentStatesTheShortestDeadTimeAndTheWindow) {
  std::ifstream file(SINEW_SOURCE_DIR "/docs/model.md");
  std::stringstream text;
  text << file.rdbuf();
  char dead_time[64], flow[64];
  std::snprintf(dead_time, sizeof dead_time, "%g samples is none", identify::kOpeningSamples);
  std::snprintf(flow, sizeof flow, "%g s of flow after every opening", identify::kAfterOpening_s);
  EXPECT_NE(text.str().find(dead_time), std::string::npos) << dead_time;
  EXPECT_NE(text.str().find(flow), std::string::npos) << flow;
}

}  // namespace
}  // namespace sinew::trace

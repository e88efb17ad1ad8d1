#include "components/trace/events.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "components/trace/tracer.h"
#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;
using identify::MakeDesign;

using identify::SyntheticModel;
using identify::SyntheticRun;
using identify::TermOf;

// The joint of synthetic.h with an event at an instant.
identify::Run RunWith(const std::string& effect, double size, std::vector<double> psi,
                      std::uint64_t seed) {
  actuator::JointModel truth = SyntheticModel();
  if (!effect.empty()) {
    truth.terms.push_back(TermOf(effect, {size}, truth.constants));
    for (std::size_t i = 0; i < psi.size(); ++i) truth.terms.back().nonlinear[i].value = psi[i];
  }
  return SyntheticRun(truth, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.05});
}

TraceResult TraceRuns(const std::vector<identify::Run>& train, const identify::Run& sealed) {
  const actuator::JointModel model = SyntheticModel();
  Design design = MakeDesign(train, model);
  Design sealed_design = MakeDesign({sealed}, model);
  TraceOptions options;
  options.placebo_rounds = 60;
  return Trace(design, sealed_design, model, options);
}

double StartIn(const TraceResult& result, const std::string& recording) {
  for (const EventTime& event : result.events) {
    if (event.recording == recording) return event.start_s;
  }
  return std::nan("");
}

TEST(Events, APayloadPutOnAtDifferentTimesIsFoundWithItsMassAndItsTimes) {
  const std::vector<identify::Run> train = {RunWith("payload_step", 0.2, {17.0}, 11),
                                            RunWith("payload_step", 0.2, {41.0}, 12),
                                            RunWith("", 0.0, {}, 13)};
  const identify::Run sealed = RunWith("payload_step", 0.2, {29.0}, 14);
  const TraceResult result = TraceRuns(train, sealed);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.size(), 1u);
  EXPECT_EQ(result.effects[0].name, "payload_step");
  const actuator::ParameterValue& mass = result.corrected.terms.back().linear[0];
  EXPECT_NEAR(mass.value, 0.2, 1.5 * mass.half_width_95.value());
  // Half a second: the resolution of a change of this size in this noise.
  EXPECT_NEAR(StartIn(result, train[0].name), 17.0, 0.5);
  EXPECT_NEAR(StartIn(result, train[1].name), 41.0, 0.5);
  EXPECT_TRUE(std::isnan(StartIn(result, train[2].name)));
  EXPECT_NEAR(StartIn(result, sealed.name), 29.0, 0.5);
  EXPECT_LT(result.after_sealed.rms, 0.3 * result.before_sealed.rms);
}

TEST(Events, APushIsFoundWhereItCame) {
  const std::vector<identify::Run> train = {RunWith("external_bump", 1.2, {20.0, 0.8}, 21),
                                            RunWith("", 0.0, {}, 22)};
  const identify::Run sealed = RunWith("external_bump", 1.2, {33.0, 0.8}, 23);
  const TraceResult result = TraceRuns(train, sealed);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects[0].name, "external_bump");
  EXPECT_NEAR(StartIn(result, train[0].name), 20.0, 0.3);
  EXPECT_TRUE(std::isnan(StartIn(result, train[1].name)));
  EXPECT_NEAR(StartIn(result, sealed.name), 33.0, 0.3);
  EXPECT_LT(result.after_sealed.rms, 0.7 * result.before_sealed.rms);
}

TEST(Events, NothingStandsOutInNoise) {
  const actuator::JointModel model = SyntheticModel();
  const Design design = MakeDesign({RunWith("", 0.0, {}, 31), RunWith("", 0.0, {}, 32)}, model);
  const identify::FitResult fit =
      identify::FitModel(design, model, identify::MakeBlocks(design.rows(), 2.0, 0.1, 8));
  const std::vector<identify::Block> blocks = identify::MakeBlocks(design.rows(), 2.0, 0.1, 8);
  for (const char* name : {"payload_step", "external_bump"}) {
    const Event event =
        FindEvent(design, effects::MakeEffect(name, model.constants), blocks, fit.balance.columns,
                  fit.balance.target - fit.balance.columns * fit.coefficients, 100, 1);
    EXPECT_FALSE(event.significant) << name << ' ' << event.statistic;
    EXPECT_GT(event.threshold, 0.0) << name;
  }
}

TEST(Events, ClocksMoveWhatEventsSeeAndNothingElse) {
  const actuator::JointModel model = SyntheticModel();
  Design design = MakeDesign({RunWith("", 0.0, {}, 41), RunWith("", 0.0, {}, 42)}, model);
  const Eigen::VectorXd time_before = design.rows().time_s;
  const auto step = effects::MakeEffect("payload_step", model.constants);
  const std::vector<double> at_30 = {30.0};
  SetClocks({10.0, std::nan("")}, 30.0, &design);
  const Eigen::MatrixXd column = design.Columns(*step, at_30);
  for (Eigen::Index i = 0; i < column.rows(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    // A second on either side: the parallel filter spreads the edge.
    const bool after = design.rows().run[k] == 0 && design.rows().time_s[i] > 11.0;
    const bool before = design.rows().run[k] == 1 || design.rows().time_s[i] < 9.0;
    if (before) {
      EXPECT_NEAR(column(i, 0), 0.0, 1e-2) << i;
    }
    if (after) {
      EXPECT_LT(column(i, 0), -0.5) << i;
    }
  }
  EXPECT_EQ(design.rows().time_s, time_before);
}

TEST(Events, WhatPushesOftenIsNoPush) {
  const actuator::JointModel model = SyntheticModel();
  identify::Run run = RunWith("", 0.0, {}, 51);
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    const double since_s = std::fmod(run.time_s[i], 9.0) - 4.0;
    if (since_s < 0.0 || since_s > 0.8) continue;
    run.signals[identify::Signal::kMotorCurrent][i] +=
        0.8 * (0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * since_s / 0.8));
  }
  const Design design = MakeDesign({run, RunWith("", 0.0, {}, 52)}, model);
  const std::vector<identify::Block> blocks = identify::MakeBlocks(design.rows(), 2.0, 0.1, 8);
  const identify::FitResult fit = identify::FitModel(design, model, blocks);
  const Event event = FindEvent(
      design, effects::MakeEffect("external_bump", model.constants), blocks, fit.balance.columns,
      fit.balance.target - fit.balance.columns * fit.coefficients, 100, 1);
  EXPECT_GT(event.statistic, kLoudest);
  EXPECT_FALSE(event.significant);
}

}  // namespace
}  // namespace sinew::trace

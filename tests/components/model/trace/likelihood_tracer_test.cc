#include "components/model/trace/likelihood_tracer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "components/model/trace/close_loop.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Recipe;
using identify::SyntheticModel;
using identify::SyntheticRun;
using identify::TermOf;
using types::Signal;

TraceResult TraceOf(const actuator::JointModel& truth, Recipe recipe,
                    const actuator::JointModel& model = SyntheticModel()) {
  recipe.rate_Hz = 100.0;
  const std::uint64_t seed = recipe.seed;
  std::vector<types::Run> train;
  for (std::uint64_t k = 0; k < 2; ++k) {
    recipe.seed = 10 * seed + k;
    train.push_back(SyntheticRun(truth, recipe));
  }
  recipe.seed = 10 * seed + 5;
  const types::Run held_out_run = SyntheticRun(truth, recipe);
  return CloseLoop(train, {held_out_run}, model, 0.25, {}).trace;
}

actuator::JointModel With(const std::string& effect, double value) {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf(effect, {value}, truth.constants));
  return truth;
}

TEST(LikelihoodTracer, AKnownEffectIsFoundFirstAndLowersTheHeldOutError) {
  const TraceResult result =
      TraceOf(With("quadratic_viscous", 0.4), {.noise_A = 0.1, .noise_memory = 0.8});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects.front().name, "quadratic_viscous");
  EXPECT_LT(result.after_held_out.rms, 0.9 * result.before_held_out.rms);
  const actuator::ParameterValue& value = result.corrected.terms.back().linear[0];
  ASSERT_TRUE(value.half_width_95.has_value());
  EXPECT_NEAR(value.value, 0.4, 1.5 * *value.half_width_95);
  EXPECT_FALSE(result.corrected.terms.back().declared);
}

TEST(LikelihoodTracer, EveryRowIsUsedOrHasAReason) {
  const TraceResult result = TraceOf(SyntheticModel(), {});
  const RowUsage& usage = result.row_usage;
  Eigen::Index rows = 0, used = 0, not_used = 0;
  for (const RowUsage::Speed& speed : usage.by_speed) {
    rows += speed.rows;
    used += speed.used;
    EXPECT_LE(speed.used, speed.rows);
  }
  for (const auto& [reason, count] : usage.not_used) not_used += count;
  EXPECT_EQ(rows, result.rows);
  EXPECT_EQ(used, result.used_rows);
  EXPECT_EQ(not_used, result.rows - result.used_rows);
  // The motion reverses and never stops: its slowest rows are those that are left out.
  ASSERT_EQ(usage.by_speed.size(), 4u);
  EXPECT_LT(usage.by_speed.front().used, 0.2 * static_cast<double>(usage.by_speed.front().rows));
  EXPECT_GT(usage.by_speed.back().used, 0.9 * static_cast<double>(usage.by_speed.back().rows));
  EXPECT_TRUE(std::any_of(usage.not_used.begin(), usage.not_used.end(), [](const auto& entry) {
    return entry.first == "near rest or a reversal";
  }));
}

TEST(LikelihoodTracer, RivalsThatPredictTheSameAreNamed) {
  const TraceResult result = TraceOf(With("direction_dependent_viscous", 0.12), {.noise_A = 0.2});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  std::vector<std::string> named = result.effects.front().rivals();
  named.push_back(result.effects.front().name);
  EXPECT_NE(std::find(named.begin(), named.end(), "direction_dependent_viscous"), named.end());
}

// Less than a period of a wave over the angle is any smooth curve: it never leads.
TEST(LikelihoodTracer, AWaveLongerThanTheMotionIsOnlyARival) {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf("gear_eccentricity", {0.0, 0.3, 0.0, 0.0}, truth.constants));
  truth.terms.back().nonlinear[0].value = 2.0;
  const TraceResult result = TraceOf(truth, {.noise_A = 0.1});
  ASSERT_FALSE(result.effects.empty());
  std::vector<std::string> rivals;
  for (const FoundEffect& found : result.effects) {
    EXPECT_NE(found.name, "gear_eccentricity");
    for (const std::string& rival : found.rivals()) rivals.push_back(rival);
  }
  EXPECT_NE(std::find(rivals.begin(), rivals.end(), "gear_eccentricity"), rivals.end());
}

TEST(LikelihoodTracer, TwoEffectsAreFoundTogether) {
  actuator::JointModel truth = With("quadratic_viscous", 0.4);
  truth.terms.push_back(TermOf("direction_dependent_viscous", {0.2}, truth.constants));
  const TraceResult result = TraceOf(truth, {.noise_A = 0.05});
  ASSERT_GE(result.effects.size(), 2u);
  std::vector<std::string> names = {result.effects[0].name, result.effects[1].name};
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"direction_dependent_viscous", "quadratic_viscous"}));
}

TEST(LikelihoodTracer, RecordingsWithoutAnEffectRaiseNoAlarm) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const TraceResult result = TraceOf(
        SyntheticModel(), {.duration_s = 40.0, .seed = seed, .noise_A = 0.1, .noise_memory = 0.9});
    alarms += result.verdict == Verdict::kNone ? 0 : 1;
  }
  EXPECT_EQ(alarms, 0);
}

TEST(LikelihoodTracer, WhatTheMotionHidesIsSaid) {
  // One temperature only: friction that drifts with it looks like friction.
  actuator::JointModel model = SyntheticModel();
  types::Run a = SyntheticRun(model, {.rate_Hz = 100.0, .seed = 1});
  types::Run b = SyntheticRun(model, {.rate_Hz = 100.0, .seed = 2});
  for (types::Run* run : {&a, &b})
    run->signals[Signal::kTemperature] = Eigen::VectorXd::Constant(run->size(), 40.0);
  const TraceResult result = CloseLoop({a}, {b}, model, 0.25, {}).trace;
  const auto hidden = [&](const std::string& name) {
    return std::any_of(result.not_excited.begin(), result.not_excited.end(),
                       [&](const NotExcited& entry) { return entry.effect == name; });
  };
  EXPECT_TRUE(hidden("temperature_friction"));
  EXPECT_TRUE(hidden("seal_hysteresis"));  // no pressure recorded
  EXPECT_TRUE(hidden("payload"));          // only a shift of gravity and inertia would show
  EXPECT_FALSE(hidden("stribeck"));
}

TEST(LikelihoodTracer, TheSameSeedGivesTheSameResult) {
  const TraceResult a =
      TraceOf(With("quadratic_viscous", 0.15), {.duration_s = 30.0, .noise_A = 0.15});
  const TraceResult b =
      TraceOf(With("quadratic_viscous", 0.15), {.duration_s = 30.0, .noise_A = 0.15});
  EXPECT_EQ(a.after_held_out.rms, b.after_held_out.rms);
  EXPECT_EQ(a.p_global, b.p_global);
}

}  // namespace
}  // namespace sinew::trace

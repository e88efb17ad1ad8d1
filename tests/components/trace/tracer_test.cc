#include "components/trace/tracer.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;
using identify::MakeDesign;
using identify::Recipe;
using identify::Signal;
using identify::SyntheticModel;
using identify::SyntheticRun;
using identify::TermOf;

TraceResult TraceOf(const actuator::JointModel& truth, Recipe recipe,
                    const actuator::JointModel& model = SyntheticModel()) {
  recipe.rate_Hz = 100.0;
  const std::uint64_t seed = recipe.seed;
  std::vector<identify::Run> train;
  for (std::uint64_t k = 0; k < 2; ++k) {
    recipe.seed = 10 * seed + k;
    train.push_back(SyntheticRun(truth, recipe));
  }
  recipe.seed = 10 * seed + 5;
  const identify::Run sealed_run = SyntheticRun(truth, recipe);
  Design design = MakeDesign(train, model);
  Design sealed = MakeDesign({sealed_run}, model);
  TraceOptions options;
  options.placebo_rounds = 60;
  return Trace(design, sealed, model, options);
}

actuator::JointModel With(const std::string& effect, double value) {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf(effect, {value}, truth.constants));
  return truth;
}

TEST(Tracer, AKnownEffectIsFoundFirstAndLowersTheSealedError) {
  const TraceResult result =
      TraceOf(With("quadratic_viscous", 0.4), {.noise_A = 0.1, .noise_memory = 0.8});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects.front().name, "quadratic_viscous");
  EXPECT_LT(result.after_sealed.rms, 0.9 * result.before_sealed.rms);
  const actuator::ParameterValue& value = result.corrected.terms.back().linear[0];
  ASSERT_TRUE(value.half_width_95.has_value());
  EXPECT_NEAR(value.value, 0.4, 1.5 * *value.half_width_95);
  EXPECT_FALSE(result.corrected.terms.back().declared);
}

TEST(Tracer, RivalsThatPredictTheSameAreNamed) {
  const TraceResult result = TraceOf(With("direction_dependent_viscous", 0.12), {.noise_A = 0.2});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  std::vector<std::string> named = result.effects.front().rivals;
  named.push_back(result.effects.front().name);
  EXPECT_NE(std::find(named.begin(), named.end(), "direction_dependent_viscous"), named.end());
}

TEST(Tracer, TwoEffectsAreFoundOneAfterTheOther) {
  actuator::JointModel truth = With("quadratic_viscous", 0.4);
  truth.terms.push_back(TermOf("direction_dependent_viscous", {0.2}, truth.constants));
  const TraceResult result = TraceOf(truth, {.noise_A = 0.05});
  ASSERT_GE(result.effects.size(), 2u);
  std::vector<std::string> names = {result.effects[0].name, result.effects[1].name};
  std::sort(names.begin(), names.end());
  EXPECT_EQ(names, (std::vector<std::string>{"direction_dependent_viscous", "quadratic_viscous"}));
}

TEST(Tracer, ALateDriveIsADelay) {
  // The current's record runs two samples ahead of its torque.
  const actuator::JointModel model = SyntheticModel();
  std::vector<identify::Run> runs;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    identify::Run run = SyntheticRun(model, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.02});
    Eigen::VectorXd& current = run.signals[Signal::kMotorCurrent];
    const Eigen::VectorXd copy = current;
    current.head(current.size() - 2) = copy.tail(copy.size() - 2);
    runs.push_back(std::move(run));
  }
  Design train = MakeDesign({runs[0], runs[1]}, model);
  Design sealed = MakeDesign({runs[2]}, model);
  const TraceResult result = Trace(train, sealed, model, {.placebo_rounds = 60});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects.front().name, "transport_delay");
  EXPECT_NEAR(actuator::PhysicalValue(result.corrected, result.effects.front().term, 0), 0.02,
              0.003);
}

TEST(Tracer, AnUndeclaredPayloadIsNamedAlthoughNoResidualIsLeft) {
  const TraceResult result = TraceOf(With("payload", 0.8), {.noise_A = 0.05});
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.front().name, "payload");
  EXPECT_TRUE(result.effects.front().swallowed);
  EXPECT_LT(result.after_sealed.rms, 0.2 * result.before_sealed.rms);
  EXPECT_FALSE(result.shifts.empty());
}

TEST(Tracer, RecordingsWithoutAnEffectRaiseNoAlarm) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const TraceResult result = TraceOf(
        SyntheticModel(), {.duration_s = 40.0, .seed = seed, .noise_A = 0.1, .noise_memory = 0.9});
    alarms += result.verdict == Verdict::kNone ? 0 : 1;
  }
  EXPECT_LE(alarms, 1);
}

TEST(Tracer, WhatTheMotionHidesIsSaid) {
  // One temperature only: friction that drifts with it looks like friction.
  actuator::JointModel model = SyntheticModel();
  identify::Run a = SyntheticRun(model, {.rate_Hz = 100.0, .seed = 1});
  identify::Run b = SyntheticRun(model, {.rate_Hz = 100.0, .seed = 2});
  for (identify::Run* run : {&a, &b})
    run->signals[Signal::kTemperature] = Eigen::VectorXd::Constant(run->size(), 40.0);
  Design train = MakeDesign({a}, model);
  Design sealed = MakeDesign({b}, model);
  const TraceResult result = Trace(train, sealed, model, {.placebo_rounds = 20});
  const auto hidden = [&](const std::string& name) {
    return std::any_of(result.not_excited.begin(), result.not_excited.end(),
                       [&](const NotExcited& entry) { return entry.effect == name; });
  };
  EXPECT_TRUE(hidden("temperature_friction"));
  EXPECT_TRUE(hidden("seal_hysteresis"));  // no pressure recorded
  EXPECT_TRUE(hidden("payload"));          // only a shift of gravity and inertia would show
  EXPECT_FALSE(hidden("quadratic_viscous"));
}

std::vector<std::string> NotExcitedOf(const TraceResult& result) {
  std::vector<std::string> out;
  for (const NotExcited& hidden : result.not_excited) out.push_back(hidden.effect);
  return out;
}

TEST(Tracer, WhatAStrongEffectHidIsJudgedBesideIt) {
  const Recipe recipe{.noise_A = 0.005};
  const TraceResult without = TraceOf(SyntheticModel(), recipe);
  const TraceResult strong = TraceOf(With("quadratic_viscous", 4.0), recipe);
  ASSERT_EQ(strong.effects.size(), 1u);
  EXPECT_EQ(NotExcitedOf(strong), NotExcitedOf(without));
}

TEST(Tracer, FrictionThatBuildsUpWithinTheEncodersCountsIsNoEffect) {
  const auto trace = [](double counts) {
    actuator::JointModel truth = SyntheticModel();
    actuator::Term term = TermOf("presliding", {0.4}, truth.constants);
    term.nonlinear[0].value = 0.02;
    truth.terms.push_back(std::move(term));
    actuator::JointModel model = SyntheticModel();
    model.constants.encoder_counts_per_turn = counts;
    return TraceOf(truth, {.noise_A = 0.05}, model);
  };
  const TraceResult fine = trace(16384.0);
  ASSERT_EQ(fine.verdict, Verdict::kEffect);
  EXPECT_EQ(fine.effects.front().name, "presliding");
  const TraceResult coarse = trace(1000.0);
  EXPECT_TRUE(std::none_of(coarse.effects.begin(), coarse.effects.end(),
                           [](const FoundEffect& found) { return found.name == "presliding"; }));
}

TEST(Tracer, TheSameSeedGivesTheSameResult) {
  const TraceResult a =
      TraceOf(With("quadratic_viscous", 0.15), {.duration_s = 30.0, .noise_A = 0.15});
  const TraceResult b =
      TraceOf(With("quadratic_viscous", 0.15), {.duration_s = 30.0, .noise_A = 0.15});
  EXPECT_EQ(a.after_sealed.rms, b.after_sealed.rms);
  EXPECT_EQ(a.rounds.front().placebo_99, b.rounds.front().placebo_99);
}

}  // namespace
}  // namespace sinew::trace

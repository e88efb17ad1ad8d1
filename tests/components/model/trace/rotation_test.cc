#include "components/model/trace/rotation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

FoundEffect Found(const std::string& name, ConfirmationVerdict verdict, double gain = 0.1,
                  std::vector<std::string> rivals = {}) {
  FoundEffect out;
  out.name = name;
  out.gain_share = gain;
  const double each = 1.0 / static_cast<double>(1 + rivals.size());
  out.posterior.push_back({name, each});
  for (const std::string& rival : rivals) out.posterior.push_back({rival, each});
  out.confirmation.verdict = verdict;
  return out;
}

Rotation With(std::vector<FoundEffect> effects, std::vector<FoundEffect> refuted = {}) {
  Rotation out;
  out.trace.effects = std::move(effects);
  out.trace.refuted = std::move(refuted);
  return out;
}

using Names = std::set<std::string>;
constexpr ConfirmationVerdict kYes = ConfirmationVerdict::kConfirmed,
                              kOpen = ConfirmationVerdict::kNotConfirmed,
                              kNo = ConfirmationVerdict::kRefuted;

TEST(AgreedEffects, AreConfirmedInAllRotationsButOne) {
  const Rotation yes = With({Found("spring", kYes)}), open = With({Found("spring", kOpen)});
  EXPECT_EQ(AgreedEffects({yes, yes, yes}), Names{"spring"});
  EXPECT_EQ(AgreedEffects({yes, open, yes}), Names{"spring"});
  EXPECT_EQ(AgreedEffects({yes, With({}), yes}), Names{"spring"});
  EXPECT_EQ(AgreedEffects({yes, open, open}), Names{});
  EXPECT_EQ(AgreedEffects({With({}), With({}), With({})}), Names{});
}

TEST(AgreedEffects, OfTwoRecordingsAreConfirmedOnBoth) {
  const Rotation yes = With({Found("spring", kYes)});
  EXPECT_EQ(AgreedEffects({yes, yes}), Names{"spring"});
  EXPECT_EQ(AgreedEffects({yes, With({Found("spring", kOpen)})}), Names{});
}

TEST(AgreedEffects, AreRefutedNowhere) {
  const Rotation yes = With({Found("spring", kYes)});
  EXPECT_EQ(AgreedEffects({yes, yes, With({}, {Found("spring", kNo)})}), Names{});
}

TEST(AgreedEffects, GoByOneNameOfTheirClass) {
  const Rotation a = With({Found("stribeck", kYes, 0.2, {"coulomb"})});
  const Rotation b = With({Found("coulomb", kYes, 0.1, {"stribeck"})});
  EXPECT_EQ(AgreedEffects({a, b, a}), Names{"stribeck"});
  EXPECT_EQ(AgreedEffects({a, b}), Names{"stribeck"});
}

TEST(RotateLoop, FitsAllRecordingsAndReportsTheErrorsOfThoseThatWereHeldOut) {
  const actuator::JointModel model = identify::SyntheticModel();
  actuator::JointModel truth = model;
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {0.4}, truth.constants));
  std::vector<types::Run> runs;
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    runs.push_back(identify::SyntheticRun(
        truth, {.rate_Hz = 100.0, .duration_s = 30.0, .seed = seed, .noise_A = 0.1}));
  }
  const TraceOptions options{};
  const RotatedLoop loop = RotateLoop(LeaveOneOut(runs, model), runs, model, 0.25, options);
  ASSERT_EQ(loop.rotations.size(), 3u);
  const TraceResult& all = loop.all.trace;
  EXPECT_EQ(all.verdict, Verdict::kEffect);
  ASSERT_EQ(all.effects.size(), 1u);
  EXPECT_EQ(all.effects[0].name, "quadratic_viscous");
  EXPECT_TRUE(all.effects[0].in_model());
  EXPECT_NEAR(all.corrected.Parameter("quadratic_viscous", "quadratic"), 0.4, 0.03);
  // Recordings of one length: the mean of the squares.
  double squares = 0.0, weakest = 1e9;
  for (std::size_t i = 0; i < 3; ++i) {
    const TraceResult& trace = loop.rotations[i].trace;
    EXPECT_EQ(loop.rotations[i].held_out, runs[i].name);
    ASSERT_EQ(trace.effects.size(), 1u);
    squares += trace.after_held_out.rms * trace.after_held_out.rms / 3.0;
    weakest = std::min(weakest, trace.effects[0].confirmation.lower);
  }
  EXPECT_NEAR(all.after_held_out.rms, std::sqrt(squares), 1e-9);
  EXPECT_DOUBLE_EQ(all.effects[0].confirmation.lower, weakest);
  EXPECT_LT(all.after_held_out.rms, all.before_held_out.rms);
}

TEST(LeaveOneOut, HoldsEachRecordingOutOnce) {
  const actuator::JointModel model = identify::SyntheticModel();
  const types::Run a = identify::SyntheticRun(model, {.seed = 1});
  const types::Run b = identify::SyntheticRun(model, {.seed = 2});
  const std::vector<Fold> folds = LeaveOneOut({a, b}, model);
  ASSERT_EQ(folds.size(), 2u);
  EXPECT_EQ(folds[0].held_out.name, a.name);
  ASSERT_EQ(folds[0].train.size(), 1u);
  EXPECT_EQ(folds[0].train[0].name, b.name);
  EXPECT_EQ(folds[1].held_out.name, b.name);
}

TEST(LeaveOneOut, ARecordingMayNotComeTwice) {
  const types::Run run = identify::SyntheticRun(identify::SyntheticModel(), {});
  EXPECT_THROW(LeaveOneOut({run, run}, identify::SyntheticModel()), std::invalid_argument);
  EXPECT_THROW(LeaveOneOut({run}, identify::SyntheticModel()), std::invalid_argument);
}

TEST(LeaveOneOut, HeldPositionsAndMotionDoNotMix) {
  types::Run moving = identify::SyntheticRun(identify::SyntheticModel(), {.seed = 1});
  types::Run held = identify::SyntheticRun(identify::SyntheticModel(), {.seed = 2});
  held.held = true;
  EXPECT_THROW(LeaveOneOut({moving, held}, identify::SyntheticModel()), std::invalid_argument);
}

TEST(RotateLoop, WhatIsGivenIsFittedWhateverTheRotationsSay) {
  const actuator::JointModel model = identify::SyntheticModel();
  std::vector<types::Run> runs;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    runs.push_back(identify::SyntheticRun(
        model, {.rate_Hz = 100.0, .duration_s = 30.0, .seed = seed, .noise_A = 0.1}));
  }
  const TraceOptions options{
      .keep_unconfirmed = true, .agreed = {{"direction_dependent_viscous"}}, .keep_refuted = true};
  const RotatedLoop loop = RotateLoop(LeaveOneOut(runs, model), runs, model, 0.25, options);
  ASSERT_EQ(loop.all.trace.effects.size(), 1u);
  EXPECT_EQ(loop.all.trace.effects[0].name, "direction_dependent_viscous");
  EXPECT_TRUE(loop.all.trace.effects[0].in_model());
  for (const Rotation& rotation : loop.rotations) EXPECT_EQ(rotation.trace.effects.size(), 1u);
}

}  // namespace
}  // namespace sinew::trace

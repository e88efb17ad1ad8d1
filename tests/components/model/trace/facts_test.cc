// Facts of a member, the score, and what becomes part of the model.
#include "components/model/trace/facts.h"

#include <gtest/gtest.h>

#include "components/model/trace/likelihood_tracer.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;

constexpr double kDrag_Nm_s2_rad2 = 0.4;

types::Run RunWithDrag(unsigned seed, double drag) {
  actuator::JointModel truth = identify::SyntheticModel();
  if (drag > 0.0) {
    truth.terms.push_back(identify::TermOf("quadratic_viscous", {drag}, truth.constants));
  }
  return identify::SyntheticRun(truth, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.05});
}

TraceResult Trace(double drag, double held_out_drag) {
  const actuator::JointModel model = identify::SyntheticModel();
  const std::vector<types::Run> train = {RunWithDrag(1, drag), RunWithDrag(2, drag)};
  const identify::ProcessingOptions options = identify::FromMotion(train, model, 0.25);
  Design design(identify::MakeStates(train, model, options), options);
  Design held_out(identify::MakeStates({RunWithDrag(3, held_out_drag)}, model, options), options);
  return TraceByLikelihood(design, held_out, model, {});
}

TEST(Facts, TheScoreFallsWithEveryFactThatSpeaksAgainstAName) {
  Facts facts;
  facts.slope = 1.0;
  facts.error = 0.01;
  EXPECT_NEAR(facts.Score(), 1.0 / (1.0 + std::exp(-2.0)), 1e-12);
  Facts other = facts;
  other.curve = 0.5;
  EXPECT_LT(other.Score(), facts.Score());
  other = facts;
  other.slope = 0.5;
  EXPECT_LT(other.Score(), rules::kScore.limit);
  // A slope that says nothing names nothing.
  other = facts;
  other.error = 1.0;
  EXPECT_FALSE(other.Assessed());
  EXPECT_LT(other.Score(), rules::kScore.limit);
  EXPECT_GT(other.Score(), rules::kOpen.limit);
  other.slope.reset();
  EXPECT_LT(other.Score(), rules::kScore.limit);
  // What began at an instant is confirmed where it is found again.
  other.SetSlope({ConfirmationVerdict::kNotConfirmed, 1.0, 0.9, 1.1, 10});
  EXPECT_TRUE(other.Assessed());
  EXPECT_NEAR(other.Score(), facts.Score(), 1e-12);
  other.SetSlope({});
  EXPECT_FALSE(other.slope);
}

TEST(Facts, AnEffectThatTheHeldOutRecordingHoldsIsPartOfTheModel) {
  const TraceResult result = Trace(kDrag_Nm_s2_rad2, kDrag_Nm_s2_rad2);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& found = result.effects[0];
  EXPECT_EQ(found.name, "quadratic_viscous");
  EXPECT_GE(found.score, rules::kScore.limit);
  EXPECT_LT(found.confirmation.lower, 1.0);
  EXPECT_GT(found.confirmation.upper, 1.0);
  EXPECT_LT(result.after_held_out.rms, result.before_held_out.rms);
}

TEST(Facts, OneThatTheHeldOutRecordingLacksIsNot) {
  const TraceResult result = Trace(kDrag_Nm_s2_rad2, 0.0);
  EXPECT_TRUE(result.effects.empty());
  EXPECT_EQ(result.corrected.Find("quadratic_viscous"), -1);
}

TEST(Facts, WithoutAnEffectNothingIsFound) {
  const TraceResult result = Trace(0.0, 0.0);
  EXPECT_EQ(result.verdict, Verdict::kNone);
  EXPECT_TRUE(result.open.empty());
}

}  // namespace
}  // namespace sinew::trace

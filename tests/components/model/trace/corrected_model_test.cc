// What the likelihood engine hands over: which effects are part of the corrected model.
#include <gtest/gtest.h>

#include "components/model/trace/likelihood_tracer.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;

constexpr double kQuadratic_Nm_s2_rad2 = 0.4;

types::Run RunWithDrag(const identify::Recipe& recipe, double drag = kQuadratic_Nm_s2_rad2) {
  actuator::JointModel truth = identify::SyntheticModel();
  truth.terms.push_back(identify::TermOf("quadratic_viscous", {drag}, truth.constants));
  return identify::SyntheticRun(truth, recipe);
}

TraceResult TraceHeldOut(const types::Run& held_out_run, const TraceOptions& trace = {}) {
  const actuator::JointModel model = identify::SyntheticModel();
  const std::vector<types::Run> train = {
      RunWithDrag({.rate_Hz = 100.0, .seed = 1, .noise_A = 0.05}),
      RunWithDrag({.rate_Hz = 100.0, .seed = 2, .noise_A = 0.05})};
  const identify::ProcessingOptions options = identify::FromMotion(train, model, 0.25);
  Design design(identify::MakeStates(train, model, options), options);
  Design held_out(identify::MakeStates({held_out_run}, model, options), options);
  return TraceByLikelihood(design, held_out, model, trace);
}

TEST(CorrectedModel, HoldsAnEffectThatTheHeldOutRecordingConfirms) {
  const TraceResult result =
      TraceHeldOut(RunWithDrag({.rate_Hz = 100.0, .seed = 3, .noise_A = 0.05}));
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.size(), 1u);
  const FoundEffect& found = result.effects[0];
  EXPECT_EQ(found.confirmation.verdict, ConfirmationVerdict::kConfirmed);
  ASSERT_TRUE(found.in_model());
  EXPECT_EQ(found.term, result.corrected.Find("quadratic_viscous"));
  ASSERT_EQ(found.fitted.size(), 1u);
  EXPECT_DOUBLE_EQ(found.fitted[0].linear[0].value,
                   actuator::PhysicalValue(result.corrected, found.term, 0));
  EXPECT_LT(result.after_held_out.rms, result.before_held_out.rms);
}

// Without a known torque the held-out recording alone does not set the drive's scale: the balance
// has training's form, or no coefficient of it would mean the same there.
TEST(CorrectedModel, HoldsAnEffectThatARecordingWithoutTheTrainedLoadConfirms) {
  const TraceResult result =
      TraceHeldOut(RunWithDrag({.rate_Hz = 100.0, .seed = 3, .noise_A = 0.05, .load_N = 0.0}));
  ASSERT_EQ(result.effects.size(), 1u);
  const Confirmation& confirmation = result.effects[0].confirmation;
  EXPECT_EQ(confirmation.verdict, ConfirmationVerdict::kConfirmed);
  EXPECT_NEAR(confirmation.slope, 1.0, 0.05);
}

// The held-out joint has two and a half times the drag: it is there, but not as trained.
TEST(CorrectedModel, LeavesOutWhatTheHeldOutRecordingDoesNotConfirmUnlessAsked) {
  const types::Run other =
      RunWithDrag({.rate_Hz = 100.0, .seed = 3, .noise_A = 0.05}, 2.5 * kQuadratic_Nm_s2_rad2);
  const TraceResult result = TraceHeldOut(other);
  EXPECT_EQ(result.verdict, Verdict::kUnexplained) << "nothing is part of the model";
  EXPECT_TRUE(result.effects.empty());
  ASSERT_EQ(result.open.size(), 1u);
  const FoundEffect& found = result.open[0];
  EXPECT_EQ(found.name, "quadratic_viscous");
  EXPECT_EQ(found.confirmation.verdict, ConfirmationVerdict::kNotConfirmed);
  EXPECT_EQ(found.refusal.rule, rules::kScore.id);
  EXPECT_LT(found.refusal.value, found.refusal.limit);
  EXPECT_FALSE(found.in_model());
  ASSERT_EQ(found.fitted.size(), 1u);
  const actuator::ParameterValue& size = found.fitted[0].linear[0];
  EXPECT_NEAR(size.value, kQuadratic_Nm_s2_rad2, 0.005 * kQuadratic_Nm_s2_rad2);
  EXPECT_EQ(result.corrected.Find("quadratic_viscous"), -1);
  EXPECT_DOUBLE_EQ(result.after_train.rms, result.before_train.rms);
  EXPECT_DOUBLE_EQ(result.after_held_out.rms, result.before_held_out.rms);

  const TraceResult kept = TraceHeldOut(other, {.keep_unconfirmed = true});
  ASSERT_EQ(kept.effects.size(), 1u);
  EXPECT_EQ(kept.effects[0].confirmation.verdict, ConfirmationVerdict::kNotConfirmed);
  EXPECT_TRUE(kept.effects[0].in_model());
  EXPECT_GE(kept.corrected.Find("quadratic_viscous"), 0);
  EXPECT_LT(kept.after_train.rms, kept.before_train.rms);
}

// Two runs of one process: what one is without, the other has.
TEST(CorrectedModel, IsDecidedByWhatIsInForceInItsOwnRun) {
  const types::Run held_out = RunWithDrag({.rate_Hz = 100.0, .seed = 3, .noise_A = 0.05});
  const TraceResult without =
      TraceHeldOut(held_out, {.in_force = {.without_effects = {"quadratic_viscous"}}});
  EXPECT_EQ(without.corrected.Find("quadratic_viscous"), -1);
  EXPECT_TRUE(without.in_force.without_effects.contains("quadratic_viscous"));
  EXPECT_GE(TraceHeldOut(held_out).corrected.Find("quadratic_viscous"), 0);
}

// The held-out joint has none of it: the page must not say that nothing was found.
TEST(CorrectedModel, KeepsWhatWasFoundInTrainingAndRefutedApartFromNothing) {
  const TraceResult result =
      TraceHeldOut(RunWithDrag({.rate_Hz = 100.0, .seed = 3, .noise_A = 0.05}, 0.0));
  EXPECT_TRUE(result.effects.empty()) << result.effects.front().name;
  EXPECT_TRUE(result.open.empty());
  ASSERT_FALSE(result.refuted.empty());
  EXPECT_EQ(result.refuted[0].name, "quadratic_viscous");
  EXPECT_EQ(result.refuted[0].confirmation.verdict, ConfirmationVerdict::kRefuted);
  EXPECT_FALSE(result.refuted[0].refusal.rule.empty());
  EXPECT_LE(result.p_global.value(), rules::kGlobalP.limit);
  EXPECT_EQ(result.verdict, NearNoise(result) ? Verdict::kNone : Verdict::kUnexplained);
}

TEST(CorrectedModel, NoiseIsWhatTheSensorsHaveNotWhatTheFitLeaves) {
  Assessment assessed;
  assessed.before_held_out.rms = 1.0;
  EXPECT_FALSE(NearNoise(assessed)) << "unknown noise";
  assessed.noise_floor_rms = 0.7;  // 0.49 of the power
  EXPECT_FALSE(NearNoise(assessed));
  assessed.noise_floor_rms = 0.72;
  EXPECT_TRUE(NearNoise(assessed));
}

}  // namespace
}  // namespace sinew::trace

// The second look: cogging that the filter of the first takes away is found where the motion is
// slow, with its order and size; without it nothing is; fast motion shows nothing and is not asked.
#include "components/trace/slow_motion.h"

#include <algorithm>
#include <cmath>

#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;
using identify::MakeDesign;
using identify::Recipe;
using identify::SyntheticModel;
using identify::SyntheticProcessing;
using identify::SyntheticRun;
using identify::TermOf;

constexpr double kRate_Hz = 100.0;

actuator::JointModel WithCogging(double sine_Nm, double order) {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf("cogging", {sine_Nm, 0.0}, truth.constants));
  truth.terms.back().nonlinear[0].value = order;
  return truth;
}

struct Looks {
  bool asked = false;
  TraceResult first;
  TraceResult both;
};

Looks LookTwice(const actuator::JointModel& truth, double slowness, std::uint64_t seed) {
  Recipe recipe{.rate_Hz = kRate_Hz,
                .duration_s = 60.0,
                .noise_A = 0.1,
                .slowness = slowness,
                .motor_position = true};
  std::vector<identify::Run> train, sealed;
  for (std::uint64_t k = 0; k < 2; ++k) {
    recipe.seed = 10 * seed + k;
    train.push_back(SyntheticRun(truth, recipe));
  }
  recipe.seed = 10 * seed + 5;
  sealed.push_back(SyntheticRun(truth, recipe));
  const actuator::JointModel model = SyntheticModel();
  TraceOptions options;
  options.placebo_rounds = 60;
  // The rig's own: 5 Hz, and what is slower than 0.05 rad/s counts as rest.
  identify::ProcessingOptions processing = SyntheticProcessing();
  processing.parallel_cutoff_Hz = 2.0;
  Design train_design = MakeDesign(train, model, processing);
  Design sealed_design = MakeDesign(sealed, model, processing);
  Looks out;
  out.first = Trace(train_design, sealed_design, model, options);
  const actuator::JointModel held = HeldForSlowMotion(out.first.corrected);
  const identify::ProcessingOptions slow = identify::SlowMotion(processing, held, kRate_Hz);
  Design slow_train = MakeDesign(train, held, slow);
  Design slow_sealed = MakeDesign(sealed, held, slow);
  out.asked = ShowsSlowMotion(slow_train, slow_sealed);
  if (!out.asked) return out;
  options.only = EffectsOfMotorAngle(held);
  out.both = WithSlowMotion(out.first, Trace(slow_train, slow_sealed, held, options));
  return out;
}

TEST(SlowMotion, ShowsCoggingThatTheFirstLookFiltersAway) {
  // 14 periods a turn at up to 0.36 rad/s of the output, ratio 50: up to 40 Hz.
  const Looks looks = LookTwice(WithCogging(0.3, 14.0), 6.0, 1);
  ASSERT_TRUE(looks.asked);
  EXPECT_EQ(looks.first.verdict, Verdict::kNone);
  ASSERT_EQ(looks.both.verdict, Verdict::kEffect);
  ASSERT_EQ(looks.both.effects.size(), 1u);
  const FoundEffect& found = looks.both.effects.front();
  EXPECT_EQ(found.name, "cogging");
  EXPECT_TRUE(found.slow_motion);
  EXPECT_TRUE(looks.both.slow_motion);
  const actuator::Term& term = looks.both.corrected.terms[static_cast<std::size_t>(found.term)];
  EXPECT_EQ(term.nonlinear[0].value, 14.0);
  ASSERT_TRUE(term.linear[0].half_width_95.has_value());
  // Filters of position and the factor of the drive take a tenth.
  EXPECT_NEAR(std::hypot(term.linear[0].value, term.linear[1].value), 0.3, 0.03);
  EXPECT_LT(looks.both.after_sealed.rms, 0.5 * looks.both.before_sealed.rms);
  EXPECT_TRUE(std::none_of(looks.both.not_excited.begin(), looks.both.not_excited.end(),
                           [](const NotExcited& hidden) { return hidden.effect == "cogging"; }));
}

TEST(SlowMotion, FindsNothingWhereNothingIs) {
  for (std::uint64_t seed = 2; seed < 6; ++seed) {
    const Looks looks = LookTwice(SyntheticModel(), 6.0, seed);
    ASSERT_TRUE(looks.asked);
    EXPECT_EQ(looks.both.verdict, Verdict::kNone) << "seed " << seed;
    EXPECT_FALSE(looks.both.slow_motion);
  }
}

TEST(SlowMotion, AFoundEffectJoinsThoseOfTheFirstLook) {
  TraceResult first;
  first.corrected = WithCogging(0.1, 7.0);
  first.effects.push_back({.name = "quadratic_viscous", .term = 2});
  first.verdict = Verdict::kEffect;
  first.noise_floor_rms = 0.5;
  TraceResult slow;
  slow.corrected = WithCogging(0.2, 14.0);
  slow.effects.push_back(
      {.name = "cogging", .term = static_cast<int>(slow.corrected.terms.size()) - 1});
  slow.noise_floor_rms = 0.1;
  const TraceResult both = WithSlowMotion(first, slow);
  ASSERT_EQ(both.effects.size(), 2u);
  EXPECT_FALSE(both.effects[0].slow_motion);
  EXPECT_TRUE(both.effects[1].slow_motion);
  EXPECT_EQ(both.effects[1].term, static_cast<int>(both.corrected.terms.size()) - 1);
  EXPECT_EQ(both.corrected.terms.back().nonlinear[0].value, 14.0);
  EXPECT_FALSE(both.slow_motion);  // errors stay those of the first look
  EXPECT_EQ(both.noise_floor_rms, 0.5);
}

TEST(SlowMotion, FastRecordingsAreNotAsked) {
  EXPECT_FALSE(LookTwice(WithCogging(0.3, 14.0), 0.05, 1).asked);
}

TEST(SlowMotion, HoldsEverythingButFrictionAndGravity) {
  const actuator::JointModel held = HeldForSlowMotion(SyntheticModel());
  for (const actuator::Term& term : held.terms) {
    const std::string& name = term.effect->info().name;
    EXPECT_EQ(term.linear[0].fixed, name != "coulomb" && name != "gravity") << name;
  }
}

}  // namespace
}  // namespace sinew::trace

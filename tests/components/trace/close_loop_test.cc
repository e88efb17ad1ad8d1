#include "components/trace/close_loop.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/components/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Recipe;
using identify::SyntheticModel;
using identify::SyntheticRun;
using identify::TermOf;

actuator::JointModel Churning() {
  actuator::JointModel truth = SyntheticModel();
  truth.terms.push_back(TermOf("quadratic_viscous", {0.4}, truth.constants));
  return truth;
}

TEST(CloseLoop, RecordingsInEffectOut) {
  const actuator::JointModel truth = Churning();
  const auto run = [&](std::uint64_t seed) {
    return SyntheticRun(truth, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.1});
  };
  const LoopResult loop = CloseLoop({run(1), run(2)}, {run(3)}, SyntheticModel(),
                                    identify::ProcessingOptions{}, {.placebo_rounds = 60});
  ASSERT_EQ(loop.trace.verdict, Verdict::kEffect);
  EXPECT_EQ(loop.trace.effects.front().name, "quadratic_viscous");
  // What was left to the data is filled in, and the designs are those that the errors are of.
  EXPECT_GT(loop.processing.parallel_cutoff_Hz, 0.0);
  ASSERT_TRUE(loop.sealed.has_value());
  EXPECT_DOUBLE_EQ(identify::ErrorOf(*loop.sealed, loop.trace.corrected).rms,
                   loop.trace.after_sealed.rms);
}

TEST(CloseLoop, ASealedRecordingThatWasTrainedOnIsRefused) {
  identify::Run run = SyntheticRun(SyntheticModel(), Recipe{.duration_s = 5.0});
  run.content_hash = "abc";
  identify::Run copy = run;
  copy.name = "copy";
  EXPECT_THROW(RequireSealed({run}, {copy}), std::invalid_argument);
  copy.content_hash = "abd";
  EXPECT_NO_THROW(RequireSealed({run}, {copy}));
}

}  // namespace
}  // namespace sinew::trace

// Recordings that are too short or too still end as a verdict, whatever it is that they lack.
#include "components/model/trace/enough_data.h"

#include <gtest/gtest.h>

#include <cmath>

#include "components/model/trace/close_loop.h"
#include "components/model/trace/rules.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

types::Run Lasting(double duration_s, std::uint64_t seed) {
  return identify::SyntheticRun(
      identify::SyntheticModel(),
      {.rate_Hz = 200.0, .duration_s = duration_s, .seed = seed, .noise_A = 0.05});
}

// Every signal but the drive stays; that has noise.
types::Run AtRest(std::uint64_t seed) {
  types::Run run = Lasting(20.0, seed);
  for (auto& [signal, values] : run.signals) {
    if (signal != types::Signal::kMotorCurrent) values.setConstant(values[0]);
  }
  return run;
}

TraceResult Assessed(const types::Run& train, const types::Run& held_out) {
  return CloseLoop({train}, {held_out}, identify::SyntheticModel(), 0.25, {}).trace;
}

TEST(EnoughData, ShortOrStillRecordingsAreTooLittleToAssess) {
  const types::Run good = Lasting(60.0, 1);
  for (const types::Run& bad : {Lasting(0.05, 2), Lasting(0.3, 2), AtRest(2)}) {
    const double seconds = bad.time_s[bad.size() - 1];
    for (const bool training : {true, false}) {
      const TraceResult result = training ? Assessed(bad, good) : Assessed(good, bad);
      EXPECT_EQ(result.verdict, Verdict::kTooLittleData) << seconds << training;
      ASSERT_TRUE(result.too_little.has_value());
      EXPECT_FALSE(result.too_little->reason.empty());
      EXPECT_LT(result.too_little->statistic, result.too_little->limit) << seconds;
      EXPECT_TRUE(result.effects.empty());
    }
  }
  EXPECT_EQ(Assessed(Lasting(0.7, 2), good).verdict, Verdict::kTooLittleData);
  EXPECT_EQ(Assessed(good, Lasting(60.0, 2)).verdict, Verdict::kNone);
}

// A free curve fits any slow noise of a few seconds; it does not predict it.
TEST(EnoughData, AShortRecordingWithoutAnEffectIsNotUnexplained) {
  const types::Run good = Lasting(60.0, 1);
  for (const double seconds : {2.0, 3.0, 5.0}) {
    for (const std::uint64_t seed : {2u, 3u, 4u, 5u}) {
      const TraceResult result = Assessed(Lasting(seconds, seed), good);
      EXPECT_EQ(result.verdict, Verdict::kNone) << seconds << " s, " << result.unexplained.variable;
    }
  }
}

TEST(EnoughData, TheRulesNameWhatIsMissing) {
  EXPECT_EQ(Assessed(AtRest(1), Lasting(60.0, 2)).too_little->rule, rules::kBlocks.id);
  EXPECT_EQ(Assessed(Lasting(60.0, 1), AtRest(2)).too_little->rule, rules::kHeldOutBlocks.id);
}

// 2^(n - 1) patterns of signs, for a change of all of them changes no gain.
TEST(EnoughData, AsManyBlocksAsASignTestNeeds) {
  EXPECT_LE(std::exp2(1.0 - rules::kBlocks.limit), rules::kGlobalP.limit);
  EXPECT_GT(std::exp2(2.0 - rules::kBlocks.limit), rules::kGlobalP.limit);
}

}  // namespace
}  // namespace sinew::trace

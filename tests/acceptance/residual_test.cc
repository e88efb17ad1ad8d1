// What the residual monitor must reach on the surrogate under control, whose physics it does not
// share.
#include "bench/acceptance/residual.h"

#include <gtest/gtest.h>

#include "sim/surrogate/random.h"
#include "tests/acceptance/acceptance.h"

namespace sinew::acceptance {
namespace {

constexpr int kSeeds = 20;

const ResidualBench& Bench() {
  static const ResidualBench kBench = LoadResidualBench(SINEW_SOURCE_DIR "/robots/rig");
  return kBench;
}

void ExpectReported(ResidualCase at) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    surrogate::RandomStream random(seed, 78);
    at.seed = seed;
    at.pressure_bar = 3.0 + 2.0 * random.Uniform();
    at.change_at_s = 45.0 + 10.0 * random.Uniform();
    at.seconds = at.change_at_s + 5.5;
    const ResidualScore score = RunResidualCase(Bench(), at);
    EXPECT_GT(score.watched_s, 1.0) << "seed " << seed << ": still learning";
    EXPECT_EQ(score.false_alarms, 0) << "seed " << seed;
    EXPECT_TRUE(score.reported) << "seed " << seed;
    EXPECT_LE(score.delay_s, kInTime_s) << "seed " << seed;
    EXPECT_TRUE(CauseIsRight(score)) << "seed " << seed << ": " << NameOf(score.follows);
  }
}

TEST(ResidualAcceptance, APayloadOfHalfAKilogramIsReportedWithinFiveSeconds) {
  ExpectReported({.payload_kg = 0.5});
}

TEST(ResidualAcceptance, DryFrictionThatGrowsByThirtyPercentIsReportedWithinFiveSeconds) {
  ExpectReported({.dry_share = 1.3});
}

TEST(ResidualAcceptance, ViscousFrictionThatGrowsByThirtyPercentIsReportedWithinFiveSeconds) {
  ExpectReported({.viscous_share = 1.3});
}

TEST(ResidualAcceptance, ChangesInEveryMotionAreReportedWithinFiveSeconds) {
  for (const ResidualCase& at : ResidualChanges(Quick())) {
    const ResidualScore score = RunResidualCase(Bench(), at);
    EXPECT_TRUE(InTime(score)) << ChangeName(at) << ", " << MotionName(at.motion) << ", seed "
                               << at.seed << ": reported " << score.reported << " after "
                               << score.delay_s << " s, " << score.false_alarms
                               << " false alarms before";
  }
}

TEST(ResidualAcceptance, MotionsWithoutAChangeRaiseNoAlarm) {
  for (const ResidualCase& at : ResidualHours(Quick())) {
    const ResidualScore score = RunResidualCase(Bench(), at);
    EXPECT_EQ(score.false_alarms, 0)
        << MotionName(at.motion) << ", seed " << at.seed << ": at " << score.first_false_s << " s";
    EXPECT_GT(score.watched_s, 0.5 * at.seconds) << MotionName(at.motion);
  }
}

TEST(ResidualAcceptance, TasksWithoutAChangeRaiseNoAlarm) {
  const ResidualScore score =
      RunResidualCase(Bench(), {.motion = ResidualMotion::kTask, .seconds = 900.0, .seed = 4711});
  EXPECT_EQ(score.false_alarms, 0) << "at " << score.first_false_s << " s";
  EXPECT_GT(score.excited_s, 750.0);
  EXPECT_LT(score.highest, 1.0);
}

}  // namespace
}  // namespace sinew::acceptance

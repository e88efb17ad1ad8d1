// The monitor against the surrogate under control, whose physics it does not share. More of it,
// with hours: `sinew check residual`.
#include <gtest/gtest.h>

#include "sim/surrogate/random.h"
#include "tools/check/residual_check.h"

namespace sinew::check {
namespace {

constexpr int kSeeds = 20;

const ResidualBench& Bench() {
  static const ResidualBench kBench = LoadResidualBench(SINEW_SOURCE_DIR "/robots/rig");
  return kBench;
}

void ExpectReported(ResidualCase at, residual::Cause cause) {
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    surrogate::RandomStream random(seed, 78);
    at.seed = seed;
    at.pressure_bar = 3.0 + 2.0 * random.Uniform();
    at.change_at_s = 45.0 + 10.0 * random.Uniform();
    at.seconds = at.change_at_s + 5.5;
    const ResidualScore score = RunResidualCase(Bench(), at);
    EXPECT_GT(score.watched_s, 1.0) << "seed " << seed << ": still learning";
    EXPECT_EQ(score.false_alarms, 0) << "seed " << seed;
    EXPECT_TRUE(score.told) << "seed " << seed;
    EXPECT_LE(score.delay_s, 5.0) << "seed " << seed;
    EXPECT_TRUE(score.follows == cause || score.rival == cause)
        << "seed " << seed << ": " << residual::CauseName(score.follows);
  }
}

TEST(ResidualOnSurrogate, APayloadOfHalfAKilogramIsReportedWithinFiveSeconds) {
  ExpectReported({.payload_kg = 0.5}, residual::Cause::kPayload);
}

TEST(ResidualOnSurrogate, DryFrictionThatGrowsByThirtyPercentIsReportedWithinFiveSeconds) {
  ExpectReported({.dry_share = 1.3}, residual::Cause::kDryFriction);
}

TEST(ResidualOnSurrogate, ViscousFrictionThatGrowsByThirtyPercentIsReportedWithinFiveSeconds) {
  ExpectReported({.viscous_share = 1.3}, residual::Cause::kViscousFriction);
}

TEST(ResidualOnSurrogate, TasksWithoutAChangeRaiseNoAlarm) {
  const ResidualScore score =
      RunResidualCase(Bench(), {.motion = ResidualMotion::kTask, .seconds = 900.0, .seed = 4711});
  EXPECT_EQ(score.false_alarms, 0) << "at " << score.first_false_s << " s";
  EXPECT_GT(score.excited_s, 750.0);
  EXPECT_LT(score.highest, 1.0);
}

}  // namespace
}  // namespace sinew::check

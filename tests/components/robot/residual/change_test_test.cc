// Blocks made by formula: what is learnt, reported and not reported is known.
#include "components/robot/residual/change_test.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

#include "tests/support/allocations.h"

namespace sinew::residual {
namespace {

enum ColumnIndex { kConstant, kSign, kSpeed, kDriveScale };

ChangeTestConfig Config(double run_length = 1e7) {
  ChangeTestConfig config;
  config.run_length_blocks = run_length;
  return config;
}

std::vector<Column> Columns() {
  return {{.cause = true}, {.cause = true}, {.cause = true}, {.cause = true, .learnt = false}};
}

// A joint that goes to and fro: blocks of 0.125 s, residual 0.1 - 0.05 sign v + noise.
class Blocks {
 public:
  explicit Blocks(std::uint64_t seed, double noise_Nm = 0.01, double correlation = 0.0)
      : random_(seed), noise_Nm_(noise_Nm), correlation_(correlation) {}

  Block Next() {
    const double t = 0.125 * at_++;
    const double v = amplitude * std::cos(frequency_rad_s * t);
    noise_ =
        correlation_ * noise_ + std::sqrt(1.0 - correlation_ * correlation_) * normal_(random_);
    Block block;
    block.column[kConstant] = 1.0;
    block.column[kSign] = v > 0.0 ? -1.0 : 1.0;
    block.column[kSpeed] = -v;
    block.drive_Nm = 1.0;
    block.column[kDriveScale] = 1.0 + 0.2 * v;
    block.residual_Nm = 0.1 + 0.05 * block.column[kSign] + noise_Nm_ * noise_ + extra_Nm -
                        viscous * block.column[kSpeed] - dry_Nm * block.column[kSign];
    block.follows_last = at_ > 1;
    return block;
  }

  double amplitude = 1.0, frequency_rad_s = 2.5;
  double viscous = 0.0, dry_Nm = 0.0, extra_Nm = 0.0;  // what came in addition

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double noise_Nm_, correlation_, noise_ = 0.0;
  int at_ = 0;
};

ChangeResult Feed(ChangeTest* test, Blocks* blocks, int count) {
  ChangeResult result;
  for (int i = 0; i < count; ++i) result = test->Step(blocks->Next());
  return result;
}

TEST(ChangeTest, LearnsFirstAndThenKnowsTheNoise) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(1);
  for (int i = 0; i < 240; ++i) {
    EXPECT_TRUE(test.last().learning) << i;
    test.Step(blocks.Next());
  }
  EXPECT_FALSE(test.last().learning);
  EXPECT_NEAR(test.noise_Nm(), 0.01, 0.002);
  const ChangeResult result = Feed(&test, &blocks, 100);
  EXPECT_FALSE(result.alarm);
  EXPECT_LT(result.innovation_rms, 0.013) << "what it learnt is not taken away";
}

TEST(ChangeTest, ReportsAChangeItsCauseItsSizeAndItsTime) {
  for (int cause : {kConstant, kSign, kSpeed}) {
    ChangeTest test(Config(), Columns());
    Blocks blocks(10 + static_cast<std::uint64_t>(cause));
    ASSERT_FALSE(Feed(&test, &blocks, 400).alarm);
    if (cause == kConstant) blocks.extra_Nm = -0.07;
    if (cause == kSign) blocks.dry_Nm = 0.07;
    if (cause == kSpeed) blocks.viscous = 0.07;
    ChangeResult result;
    int after = 0;
    do {
      result = test.Step(blocks.Next());
    } while (!result.alarm && ++after < 40);
    ASSERT_TRUE(result.alarm) << cause;
    EXPECT_NEAR(result.blocks_since, after + 1, 3) << cause;
    result = Feed(&test, &blocks, 20);
    EXPECT_EQ(result.cause, cause);
    EXPECT_NEAR(result.change, 0.07, 4.0 * result.change_error) << cause;
    EXPECT_GT(result.explained, 0.8);
  }
}

// One block of +3 Nm counts clip_sigmas = 5 standard deviations at once, less the slack of 0.01 Nm
// over the noise of 0.01 Nm: Z = 4.
TEST(ChangeTest, TheNewestBlockCountsAtOnce) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(15);
  ASSERT_LT(Feed(&test, &blocks, 400).statistic, 3.0);
  blocks.extra_Nm = 3.0;
  EXPECT_NEAR(test.Step(blocks.Next()).statistic, 4.0, 0.4);
}

// Blocks that do not follow each other in time say nothing about the noise's correlation.
TEST(ChangeTest, MeasuresCorrelationOnlyBetweenBlocksThatFollowEachOther) {
  for (const bool follows : {true, false}) {
    ChangeTest test(Config(), Columns());
    Blocks learnt(16);
    Feed(&test, &learnt, 240);
    Blocks correlated(17, 0.01, 0.8);
    for (int i = 0; i < 1500; ++i) {
      Block block = correlated.Next();
      block.follows_last = follows;
      test.Step(block);
    }
    if (follows) {
      EXPECT_GT(test.correlation(), 3.0);
    } else {
      EXPECT_LT(test.correlation(), 2.0);
    }
  }
}

TEST(ChangeTest, NamesTheRivalThatTheMotionDoesNotDistinguish) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(3);
  blocks.frequency_rad_s = 0.0;  // one speed, one direction: offset, dry and viscous are the same
  ASSERT_FALSE(Feed(&test, &blocks, 300).alarm);
  blocks.viscous = 0.1;
  const ChangeResult result = Feed(&test, &blocks, 20);
  EXPECT_TRUE(result.alarm);
  EXPECT_GE(result.cause, 0);
  EXPECT_GE(result.rival, 0);
  EXPECT_NE(result.cause, result.rival);
}

TEST(ChangeTest, AnAlarmEndsWhenTheChangeHasGoneAndLearningWentOnFromBefore) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(4);
  Feed(&test, &blocks, 300);
  blocks.viscous = 0.1;
  EXPECT_TRUE(Feed(&test, &blocks, 200).alarm) << "it does not get used to it";
  blocks.viscous = 0.0;
  EXPECT_FALSE(Feed(&test, &blocks, 90).alarm);
  blocks.viscous = 0.1;
  EXPECT_TRUE(Feed(&test, &blocks, 40).alarm) << "and the next one is reported again";
}

TEST(ChangeTest, OneBlockIsABumpAndSmallChangesRaiseNoAlarm) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(5);
  Feed(&test, &blocks, 400);
  blocks.extra_Nm = 3.0;
  EXPECT_FALSE(test.Step(blocks.Next()).alarm);
  blocks.extra_Nm = 0.0;
  EXPECT_FALSE(Feed(&test, &blocks, 100).alarm);
  blocks.extra_Nm = 0.5 * test.slack_Nm();
  EXPECT_FALSE(Feed(&test, &blocks, 2000).alarm);
}

TEST(ChangeTest, AMotionThatWasNotLearntIsMoreToLearnFrom) {
  // Creeping while learning: what depends on speed cannot be known. Then fast, with viscous
  // friction that the model has wrong.
  ChangeTest test(Config(), Columns());
  Blocks blocks(6);
  blocks.amplitude = 0.02;
  blocks.viscous = 0.05;
  ASSERT_FALSE(Feed(&test, &blocks, 300).alarm);
  blocks.amplitude = 1.0;
  EXPECT_FALSE(Feed(&test, &blocks, 600).alarm);
  blocks.viscous = 0.15;
  EXPECT_TRUE(Feed(&test, &blocks, 40).alarm) << "learnt by now";
}

// Slack 0, so that the run length is that of the test alone. Learning adds to the rate: what is
// learnt is not exact.
TEST(ChangeTest, RunsAsLongAsWasAskedForBlocksThatAreIndependentOrNot) {
  for (const double correlation : {0.0, 0.6}) {
    constexpr double kAsked = 3000.0;
    constexpr int kSeeds = 40;
    long blocks_seen = 0;
    int alarms = 0;
    for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
      ChangeTestConfig config = Config(kAsked);
      config.slack_share = 0.0;
      ChangeTest test(config, Columns());
      Blocks blocks(100 + seed, 0.01, correlation);
      Feed(&test, &blocks, config.learn_blocks);
      bool before = false;
      for (int i = 0; i < 3000; ++i) {
        const ChangeResult result = test.Step(blocks.Next());
        alarms += result.alarm && !before;
        blocks_seen += !result.alarm;
        before = result.alarm;
      }
    }
    RecordProperty("alarms_" + std::to_string(static_cast<int>(10 * correlation)), alarms);
    // With 40 expected, 60 is the 99.8th percentile; an alarm ahead of its time now and then is
    // what the estimated noise costs.
    EXPECT_LT(alarms, 80) << "correlation " << correlation << ": one in "
                          << blocks_seen / std::max(1, alarms) << " blocks";
  }
}

TEST(ChangeTest, AnHourAndALongRunStayFinite) {
  ChangeTest test(Config(1e8), Columns());
  Blocks blocks(7, 0.01, 0.5);
  const ChangeResult result = Feed(&test, &blocks, 200000);
  EXPECT_FALSE(result.alarm);
  EXPECT_TRUE(std::isfinite(result.statistic));
  EXPECT_NEAR(test.noise_Nm(), 0.01 * std::sqrt(3.0), 0.01);
}

TEST(ChangeTest, BrokenBlocksChangeNothing) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(8);
  Block broken = blocks.Next();
  broken.residual_Nm = NAN;
  test.Step(broken);
  Feed(&test, &blocks, 300);
  broken = blocks.Next();
  broken.column[kSpeed] = INFINITY;
  EXPECT_FALSE(test.Step(broken).alarm);
  EXPECT_FALSE(Feed(&test, &blocks, 100).alarm);
}

TEST(ChangeTest, TakesNoMemoryOnceItHasLearnt) {
  ChangeTest test(Config(), Columns());
  Blocks blocks(9);
  Feed(&test, &blocks, 240);
  const long before = test::Allocations();
  Feed(&test, &blocks, 300);
  blocks.viscous = 0.2;
  Feed(&test, &blocks, 60);
  EXPECT_EQ(test::Allocations(), before);
}

TEST(ChangeTest, RefusesWhatCannotBe) {
  EXPECT_THROW(ChangeTest(Config(), {}), std::invalid_argument);
  EXPECT_THROW(ChangeTest(Config(), {{.cause = false}}), std::invalid_argument);
  EXPECT_THROW(ChangeTest(Config(), std::vector<Column>(kMaxColumns + 1, Column{.cause = true})),
               std::invalid_argument);
  ChangeTestConfig config = Config(5.0);
  EXPECT_THROW(ChangeTest(config, Columns()), std::invalid_argument);
  config = Config();
  config.learn_blocks = 10;
  EXPECT_THROW(ChangeTest(config, Columns()), std::invalid_argument);
  config = Config();
  config.clip_sigmas = 0.5;
  EXPECT_THROW(ChangeTest(config, Columns()), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::residual

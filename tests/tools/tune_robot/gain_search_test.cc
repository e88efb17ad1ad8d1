// The search of gains with trials written for these tests: a bowl, and a robot that falls when the
// gains are low.
#include "tools/tune_robot/gain_search.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>

namespace sinew::tune {
namespace {

constexpr double kFallsBelow_Nm_rad = 60.0;

// Its bottom is at 200, 20, 5; a proportional gain too low falls, the sooner the lower it is.
ClosedLoopScore BowlTrial(const control::PidConfig& pid) {
  ClosedLoopScore score;
  score.mse_rad2 = 1e-4 * (1.0 + std::pow(std::log(pid.proportional_Nm_rad / 200.0), 2) +
                           std::pow(std::log(pid.integral_Nm_rad_s / 20.0), 2) +
                           std::pow(std::log(pid.derivative_Nm_s_rad / 5.0), 2));
  if (pid.proportional_Nm_rad < kFallsBelow_Nm_rad) {
    score.fell_at_s = pid.proportional_Nm_rad / 30.0;
  }
  return score;
}

GainSearchConfig BowlSearch() {
  GainSearchConfig config;
  config.search.trials = 40;
  config.search.proportional = {20.0, 1000.0};
  config.search.integral = {0.5, 500.0};
  config.search.derivative = {0.2, 20.0};
  config.compared = {{"published", 60.0, 3.5, 1.0}, {"bottom", 200.0, 20.0, 5.0}};
  config.rest.derivative_filter_Hz = 20.0;
  return config;
}

void ExpectSame(const GainSearchResult& a, const GainSearchResult& b) {
  ASSERT_EQ(a.trials.size(), b.trials.size());
  for (std::size_t i = 0; i < a.trials.size(); ++i) {
    EXPECT_EQ(a.trials[i].stage, b.trials[i].stage);
    EXPECT_EQ(a.trials[i].number, b.trials[i].number);
    EXPECT_EQ(a.trials[i].pid.proportional_Nm_rad, b.trials[i].pid.proportional_Nm_rad);
    EXPECT_EQ(a.trials[i].pid.integral_Nm_rad_s, b.trials[i].pid.integral_Nm_rad_s);
    EXPECT_EQ(a.trials[i].pid.derivative_Nm_s_rad, b.trials[i].pid.derivative_Nm_s_rad);
    EXPECT_EQ(a.trials[i].score.value().mse_rad2, b.trials[i].score.value().mse_rad2);
  }
  ASSERT_TRUE(a.best && b.best);
  EXPECT_EQ(a.best->stage, b.best->stage);
  EXPECT_EQ(a.best->number, b.best->number);
}

TEST(GainSearch, TheNumberOfThreadsChangesNothing) {
  GainSearchConfig config = BowlSearch();
  const GainSearchResult one = RunGainSearch(config, {}, BowlTrial, {});
  config.threads = 4;
  const GainSearchResult four = RunGainSearch(config, {}, BowlTrial, {});
  EXPECT_EQ(one.trials.size(), 2u + 2u * 40u);
  ExpectSame(one, four);
}

TEST(GainSearch, FindsTheBottomOfTheBowlInTheSecondStage) {
  const GainSearchResult result = RunGainSearch(BowlSearch(), {}, BowlTrial, {});
  ASSERT_TRUE(result.best.has_value());
  EXPECT_EQ(result.best->stage, 2);
  // 40 draws in logarithms 0.69 wide about the best of 40 in logarithms 3.9, 6.9 and 4.6 wide: the
  // cell of one draw is 1.4 wide at first, so half of it is left to the second stage.
  EXPECT_LT(result.best->cost(), 1e-4 * (1.0 + 3.0 * 0.7 * 0.7));
  EXPECT_EQ(result.best->pid.derivative_filter_Hz, 20.0) << "the rest stays";
}

TEST(GainSearch, AFallIsKeptWithItsTimeAndNeverTheBest) {
  const GainSearchResult result = RunGainSearch(BowlSearch(), {}, BowlTrial, {});
  int fell = 0;
  for (const GainTrial& trial : result.trials) {
    const bool falls = trial.pid.proportional_Nm_rad < kFallsBelow_Nm_rad;
    ASSERT_TRUE(trial.score.has_value());
    ASSERT_EQ(trial.score->fell_at_s.has_value(), falls);
    if (!falls) continue;
    ++fell;
    EXPECT_EQ(trial.cost(), kDiscarded);
    EXPECT_EQ(*trial.score->fell_at_s, trial.pid.proportional_Nm_rad / 30.0);
  }
  EXPECT_GT(fell, 5);
  EXPECT_GE(result.best->pid.proportional_Nm_rad, kFallsBelow_Nm_rad);
}

TEST(GainSearch, NamedGainsAreRunButAreNeverTheBest) {
  const GainSearchResult result = RunGainSearch(BowlSearch(), {}, BowlTrial, {});
  EXPECT_EQ(result.trials[1].name, "bottom");
  EXPECT_EQ(result.trials[1].cost(), 1e-4);
  EXPECT_GT(result.best->cost(), 1e-4);
}

TEST(GainSearch, GoesOnFromWhatIsDoneAndRunsTheRestOnly) {
  const GainSearchConfig config = BowlSearch();
  const GainSearchResult whole = RunGainSearch(config, {}, BowlTrial, {});
  // Stopped in the middle of stage 1, and in the middle of stage 2; out of order, as threads end.
  for (const std::size_t kept : {20u, 60u}) {
    std::vector<GainTrial> done(whole.trials.begin(),
                                whole.trials.begin() + static_cast<std::ptrdiff_t>(kept));
    std::swap(done[3], done[7]);
    std::atomic<std::size_t> runs = 0;
    std::size_t kept_again = 0;
    const GainSearchResult resumed = RunGainSearch(
        config, done,
        [&runs](const control::PidConfig& pid) {
          ++runs;
          return BowlTrial(pid);
        },
        [&kept_again](const GainTrial& /*trial*/) { ++kept_again; });
    EXPECT_EQ(runs, whole.trials.size() - kept);
    EXPECT_EQ(kept_again, runs);
    ExpectSame(whole, resumed);
  }
}

TEST(GainSearch, WithoutATrialThatStandsThereIsNoSecondStage) {
  const auto falls = [](const control::PidConfig& /*pid*/) {
    ClosedLoopScore score;
    score.fell_at_s = 1.0;
    return score;
  };
  const GainSearchResult result = RunGainSearch(BowlSearch(), {}, falls, {});
  EXPECT_FALSE(result.best.has_value());
  EXPECT_EQ(result.trials.size(), 2u + 40u);
}

TEST(GainSearch, RefusesTrialsOfAnotherSearch) {
  const GainSearchConfig config = BowlSearch();
  std::vector<GainTrial> done = RunGainSearch(config, {}, BowlTrial, {}).trials;
  GainSearchConfig other = config;
  other.search.seed = 2;
  EXPECT_THROW((void)PlanTrials(other, done), std::invalid_argument);
  done.back().number = 1000;
  EXPECT_THROW((void)PlanTrials(config, done), std::invalid_argument);
}

TEST(GainSearch, WhatATrialThrowsEndsTheSearch) {
  const auto throws = [](const control::PidConfig& /*pid*/) -> ClosedLoopScore {
    throw std::invalid_argument("no robot");
  };
  EXPECT_THROW((void)RunGainSearch(BowlSearch(), {}, throws, {}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::tune

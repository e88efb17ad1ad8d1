#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "components/model/trace/facts.h"

namespace sinew::trace {
namespace {

constexpr Eigen::Index kSlopeRows = 3000;

std::vector<identify::Block> Blocks(int count) {
  std::vector<identify::Block> out;
  const Eigen::Index length = kSlopeRows / count;
  for (int b = 0; b < count; ++b) {
    out.emplace_back(static_cast<std::size_t>(length));
    std::iota(out.back().begin(), out.back().end(), b * length);
  }
  return out;
}

Eigen::VectorXd NormalRows(unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Eigen::VectorXd out(kSlopeRows);
  for (double& value : out) value = normal(random);
  return out;
}

Confirmation Of(double slope, unsigned seed, int blocks = 30) {
  const Eigen::VectorXd change = 0.3 * NormalRows(seed);
  return ConfirmSlope(slope * change + NormalRows(seed + 1000), change, Blocks(blocks), {});
}

TEST(Confirmation, TheSlopeIsTheSizeOverTheTrainedOne) {
  for (const double size : {-1.0, 0.0, 1.0, 2.5}) {
    const Confirmation found = Of(size, 1);
    EXPECT_NEAR(found.slope, size, 0.2);
    EXPECT_LT(found.lower, size);
    EXPECT_GT(found.upper, size);
    EXPECT_EQ(found.blocks, 30);
  }
}

TEST(Confirmation, TooFewBlocksGiveNoInterval) {
  const Confirmation found = Of(1.0, 5, 3);
  EXPECT_EQ(found.lower, found.upper);
}

TEST(Confirmation, WithoutTheRuleOfBlocksTwoGiveAnInterval) {
  const Eigen::VectorXd change = 0.3 * NormalRows(5);
  const InForce without{.without_rules = {"held_out_blocks"}};
  for (const int blocks : {1, 2, 3}) {
    const Confirmation found =
        ConfirmSlope(change + NormalRows(1005), change, Blocks(blocks), without);
    EXPECT_EQ(found.upper > found.lower, blocks > 1) << blocks;
  }
}

TEST(Confirmation, AChangeThatTheHeldOutMotionDoesNotExciteGivesNoInterval) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(kSlopeRows);
  const Confirmation found = ConfirmSlope(NormalRows(6), none, Blocks(30), {});
  EXPECT_EQ(found.lower, found.upper);
}

TEST(Confirmation, IntervalsHoldTheTrueSlope) {
  int held = 0;
  constexpr int kTrials = 400;
  for (unsigned trial = 0; trial < kTrials; ++trial) {
    const Confirmation found = Of(1.0, 100 + trial);
    held += found.lower < 1.0 && found.upper > 1.0 ? 1 : 0;
  }
  // 95 % of 400 with three standard errors of the count.
  EXPECT_NEAR(held, 380, 14);
}

}  // namespace
}  // namespace sinew::trace

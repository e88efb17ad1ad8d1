// Oracle: links that give way at a force that was put in.
#include "components/model/experiment/breakaway.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>

#include "tests/support/rig_constants.h"

namespace sinew::experiment {
namespace {

// A force that grows at 1 N/s; the link creeps by 2 mrad and then falls.
Recording Trial(double angle_rad, double breakaway_N, unsigned seed, double start_s = 0.0) {
  std::mt19937 random(seed);
  std::normal_distribution<double> gauss;
  Recording rows;
  const double break_s = breakaway_N / 1.0;
  for (int i = 0; i / 240.0 < break_s + 0.3; ++i) {
    const double t = i / 240.0;
    Row row;
    row.time_s = start_s + t;
    double q = angle_rad - 2e-3 * std::min(1.0, std::pow(t / break_s, 8));
    double force_N = t;
    if (t > break_s) {
      const double fallen_rad = 20.0 * (t - break_s) * (t - break_s);
      q -= fallen_rad;
      force_N = std::max(0.0, t - 150.0 * fallen_rad);  // the hand is a spring
    }
    row.output_angle_rad = kCount_rad * std::round((q + 1.5e-4 * gauss(random)) / kCount_rad);
    row.load_force_N = force_N + 0.05 * gauss(random);
    rows.push_back(row);
  }
  return rows;
}

TEST(Breakaway, ForceOfATrialIsFoundWithinTheNoiseOfItsRows) {
  const std::vector<Breakaway> found = FindBreakaways(Trial(0.5, 3.0, 1));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].angle_rad, 0.5, 1e-3);
  EXPECT_NEAR(found[0].force_N, 3.0, 0.06);  // 0.05 N a row, a parabola through 67
  EXPECT_NEAR(found[0].row_s, 1.0 / 240.0, 1e-6);
}

TEST(Breakaway, SeveralTrialsInOneRecordingAreReported) {
  Recording rows;
  for (int i = 0; i < 3; ++i) {
    const Recording one = Trial(0.3 * i, 2.0 + i, static_cast<unsigned>(i), 20.0 * i);
    rows.insert(rows.end(), one.begin(), one.end());
  }
  EXPECT_EQ(FindBreakaways(rows).size(), 3u);
}

TEST(Breakaway, ALinkThatIsCarriedOrNotPressedIsNoBreakaway) {
  Recording moved, still;
  for (int i = 0; i < 1200; ++i) {
    Row row;
    row.time_s = i / 240.0;
    row.load_force_N = 2.0;
    row.output_angle_rad = -0.1 * row.time_s;  // carried down evenly
    moved.push_back(row);
    row.output_angle_rad = 0.0;
    still.push_back(row);
  }
  EXPECT_TRUE(FindBreakaways(moved).empty());
  EXPECT_TRUE(FindBreakaways(still).empty());
  EXPECT_TRUE(FindBreakaways({}).empty());
}

TEST(Breakaway, FrictionAndGravityComeBack) {
  std::vector<Breakaway> trials;
  std::mt19937 random(2);
  std::normal_distribution<double> gauss(0.0, 0.03);
  for (const double angle_deg : kBreakawayAngles_deg) {
    for (int i = 0; i < 20; ++i) {
      const double angle_rad = angle_deg * kDegree;
      trials.push_back(
          {angle_rad, (1.22 - 0.58 * std::cos(angle_rad)) / 0.3 + gauss(random), 1.0, 1.0 / 240.0});
    }
  }
  const Result result = IdentifyBreakaway(trials, {});
  EXPECT_TRUE(result.Find("static_friction_Nm")->estimate.Covers(1.22));
  EXPECT_TRUE(result.Find("gravity_Nm")->estimate.Covers(0.58));
  EXPECT_EQ(result.tables.at(0).rows.size(), 9u);
  // The instant is known to one row: 0.3 Nm/s over 1/240 s.
  EXPECT_GE(result.Find("static_friction_Nm")->estimate.half_width_95, 0.3 / 240.0);
}

TEST(Breakaway, OneAngleCannotSeparateFrictionFromGravity) {
  const std::vector<Breakaway> trials(9, {0.0, 2.0, 1.0, 1.0 / 240.0});
  EXPECT_THROW((void)IdentifyBreakaway(trials, {}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::experiment

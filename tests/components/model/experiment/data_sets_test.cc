#include "components/model/experiment/data_sets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "components/base/types/control_mode.h"

namespace sinew::experiment {
namespace {

TEST(SeaData, AHandPushesAboutTwiceASecondAndOnlyDown) {
  SeaProtocol protocol({.duration_s = 100.0});
  int pushes = 0;
  bool pushing = false;
  double lowest_N = 0.0, highest_N = 0.0;
  for (int i = 0; i < 24000; ++i) {
    const double force_N = protocol.Step({.time_s = i / 240.0}).hand_force_N;
    lowest_N = std::min(lowest_N, force_N);
    highest_N = std::max(highest_N, force_N);
    if (!pushing && force_N > 2.0) ++pushes;
    pushing = force_N > 0.5 ? (pushing || force_N > 2.0) : false;
  }
  EXPECT_NEAR(pushes, 198, 4);  // the first second is left alone
  EXPECT_EQ(lowest_N, 0.0);
  EXPECT_LT(highest_N, 13.0);
  EXPECT_GT(highest_N, 10.0);
}

TEST(SeaData, TheLeakFollowsAStraightLine) {
  SeaProtocol protocol({.duration_s = 100.0, .first_bar = 6.0});
  EXPECT_FALSE(protocol.Step({.time_s = 50.0, .reservoir_pressure_bar = 2.9}).vent_open);
  EXPECT_TRUE(protocol.Step({.time_s = 50.0, .reservoir_pressure_bar = 3.1}).vent_open);
}

// Square pushes; the link comes back until `last_back`.
Recording SeaRows(int pushes, int last_back) {
  Recording rows;
  for (int i = 0; i < pushes * 120; ++i) {
    const int push = i / 120, local = i % 120;
    Row row;
    row.time_s = i / 240.0;
    row.load_force_N = local < 50 ? 8.0 : 0.0;
    const bool stuck = push > last_back;
    row.output_angle_rad = stuck || (local >= 5 && local < 70) ? -0.023 : 0.023;
    row.chamber_pressure_bar = 6.0 - 0.1 * push;
    rows.push_back(row);
  }
  return rows;
}

TEST(SeaData, TheSetEndsWhereTheLinkNoLongerComesBack) {
  const Recording rows = SeaRows(40, 30);
  const Recording set = TrimSea(rows);
  EXPECT_NEAR(set.back().time_s, 31.0 * 0.5, 0.51);
  const Result result = DescribeSea(rows, {});
  EXPECT_NEAR(result.Find("pushes_Hz")->estimate.value, 2.0, 1e-6);
  EXPECT_NEAR(result.Find("set_end_bar")->estimate.value, 3.0, 0.15);
  // A square loop: 8 N x 0.3 m over 0.046 rad on the way down, nothing on the way back.
  EXPECT_NEAR(result.Find("cycle_loss_J")->estimate.value, 2.4 * 0.046, 0.01);
}

TEST(SeaData, TooLittleIsRefused) {
  EXPECT_THROW((void)DescribeSea({}, {}), std::invalid_argument);
  EXPECT_THROW((void)DescribeSea(SeaRows(2, 5), {}), std::invalid_argument);
  EXPECT_THROW(SeaProtocol({.force_N = 0.0}), std::invalid_argument);
}

TEST(PeaData, AHandTakesTheLinkFromUprightToHangingAndNeverPulls) {
  PeaProtocol protocol({.cycles = 5});
  Reading reading{.output_angle_rad = 1.5708};
  int cycles = 0;
  bool below = false;
  for (int i = 0; i < 240 * 40 && !protocol.done(); ++i) {
    reading.time_s = i / 240.0;
    const Command command = protocol.Step(reading);
    ASSERT_GE(command.hand_force_N, 0.0);
    ASSERT_EQ(command.drive, types::ControlMode::kTorque);
    // A link without inertia: goes where the hand presses, comes back where it does not.
    reading.output_angle_rad += command.hand_force_N > 1.0 ? -0.02 : 0.02;
    reading.output_angle_rad = std::clamp(reading.output_angle_rad, -1.6, 1.5708);
    if (!below && reading.output_angle_rad < -1.2) {
      below = true;
      ++cycles;
    }
    if (reading.output_angle_rad > 1.2) below = false;
  }
  EXPECT_TRUE(protocol.done());
  EXPECT_EQ(cycles, 5);
}

TEST(PeaData, CyclesAndRangeAreReported) {
  Recording rows;
  for (int i = 0; i < 240 * 20; ++i) {
    Row row;
    row.time_s = i / 240.0;
    row.output_angle_rad = 1.5 * std::cos(2.0 * 3.14159265358979 * row.time_s / 4.0);
    rows.push_back(row);
  }
  const Result result = DescribePea(rows, {});
  EXPECT_EQ(result.Find("cycles")->estimate.value, 5.0);
  EXPECT_NEAR(result.Find("lowest_deg")->estimate.value, -85.9, 0.2);
  EXPECT_THROW((void)DescribePea({}, {}), std::invalid_argument);
  EXPECT_THROW(PeaProtocol({.cycles = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::experiment

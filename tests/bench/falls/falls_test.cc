// A fall of each kind and a healthy squat, as bench/falls makes them, and what its table says of
// misses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>

#include "bench/falls/table.h"

namespace sinew::falls {
namespace {

using ::testing::HasSubstr;

constexpr std::uint64_t kSeed = 50000;  // none that is published
const ProvokeOptions kOptions{.root = SINEW_SOURCE_DIR};

// The first draw of this kind, by the drives' position loops, that topples the robot.
FallRun FallOf(Kind kind) {
  for (int number = 0; number < 100; ++number) {
    const Scenario scenario = DrawFall(kSeed, number);
    if (scenario.kind != kind || scenario.controller != Controller::kPosition) continue;
    if (const auto run = ProvokeFall(scenario, kOptions)) return *run;
  }
  ADD_FAILURE() << "no draw topples the robot";
  return {};
}

TEST(Falls, OneOfEachKindIsFoundInTimeAndTheJointsAreAsDeclared) {
  for (const Kind kind : {Kind::kPush, Kind::kLostDrive, Kind::kSlip}) {
    const FallRun run = FallOf(kind);
    std::ostringstream line;
    Print(run, line);
    EXPECT_TRUE(run.found()) << line.str();
    EXPECT_TRUE(run.guarded.safe) << line.str();
    EXPECT_THAT(run.guarded.message, HasSubstr("fall: "));
  }
}

TEST(Falls, TheSameNumberIsTheSameRun) {
  const Scenario scenario = DrawFall(kSeed, 0);
  const auto first = ProvokeFall(scenario, kOptions), second = ProvokeFall(scenario, kOptions);
  ASSERT_EQ(first.has_value(), second.has_value());
  if (!first) return;
  EXPECT_EQ(first->guarded.message, second->guarded.message);
  EXPECT_EQ(first->guarded.fault_s, second->guarded.fault_s);
}

TEST(Falls, HealthySquatsWithALoadAreNoAlarm) {
  for (int number = 0; number < kSquatKinds; ++number) {
    const Scenario scenario = DrawSquats(kSeed, number);
    if (scenario.kind != Kind::kPayload) continue;
    const auto run = WatchSquats(scenario, kOptions);
    ASSERT_TRUE(run) << "not healthy";
    EXPECT_FALSE(run->alarm()) << run->guarded.message;
    EXPECT_GT(run->guarded.largest_tilt_rad, 0.0);
  }
}

FallRun Written(double fell_s, double fault_s, bool safe) {
  FallRun run;
  run.scenario.acts_at_s = 4.0;
  run.unguarded.fell_s = fell_s;
  run.guarded.fault_s = fault_s;
  run.guarded.safe = safe;
  return run;
}

TEST(FallsTable, AMissAnAlarmOrJointsThatAreNotAsDeclaredAreNoGood) {
  const auto good = [](const std::vector<FallRun>& falls, const std::vector<SquatRun>& squats) {
    std::ostringstream out;
    return PrintTable(falls, squats, out);
  };
  SquatRun healthy;
  healthy.guarded.upright_s = 2.0;
  EXPECT_TRUE(good({Written(5.0, 5.09, true)}, {healthy}));
  EXPECT_TRUE(good({Written(5.0, 4.5, true)}, {healthy})) << "before the truth, after the push";
  EXPECT_FALSE(good({Written(5.0, 5.11, true)}, {healthy})) << "too late";
  EXPECT_FALSE(good({Written(5.0, 3.9, true)}, {healthy})) << "before anything happened";
  EXPECT_FALSE(good({Written(5.0, 5.0, false)}, {healthy}));
  SquatRun alarm = healthy;
  alarm.guarded.fault_s = 6.0;
  EXPECT_FALSE(good({Written(5.0, 5.0, true)}, {healthy, alarm}));
  SquatRun late = healthy;
  late.guarded.upright_s = 3.6;
  EXPECT_FALSE(good({}, {late})) << "the squats began unwatched";
  late.guarded.upright_s = -1.0;
  EXPECT_FALSE(good({}, {late}));
}

}  // namespace
}  // namespace sinew::falls

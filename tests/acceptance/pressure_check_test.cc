// Oracle: the surrogate's true pressure, breakages whose name is known.
#include "tools/acceptance/pressure_check.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "components/pneumatics/file/pneumatics_file.h"

namespace sinew::check {
namespace {

pneumatics::ManagerConfig RigManager() {
  return pneumatics::LoadPneumatics(std::string(SINEW_SOURCE_DIR) + "/robots/rig/pneumatics.yaml")
      .joints.at(0);
}

TEST(PressureCheck, TheRigsManagerHoldsAPressureAndSparesItsRelays) {
  const HoldScore score = RunHoldCase(RigManager(), {.target_bar = 2.0, .seconds = 15.0});
  ASSERT_TRUE(score.settled);
  EXPECT_EQ(score.fault, pneumatics::Fault::kNone);
  EXPECT_LE(score.worst_bar, 0.05);
  EXPECT_GE(score.shortest_on_s, -1e-9);
  EXPECT_GE(score.shortest_off_s, -1e-9);
}

TEST(PressureCheck, AStiffnessIsHeldThroughTheIdentifiedTable) {
  const HoldScore score =
      RunHoldCase(RigManager(), {.target_stiffness_Nm_rad = 15.42, .seconds = 12.0});
  EXPECT_NEAR(score.target_bar, 3.0, 1e-6);
  EXPECT_TRUE(score.settled);
}

TEST(PressureCheck, AnUnknownStiffnessIsNotHeld) {
  const HoldScore score =
      RunHoldCase(RigManager(), {.target_stiffness_Nm_rad = 100.0, .seconds = 1.0});
  EXPECT_FALSE(score.settled);
}

TEST(PressureCheck, ABrokenSensorIsToldAndSafe) {
  const FaultScore score = RunFaultCase(RigManager(), Breakage::kSensorBroken);
  EXPECT_EQ(score.fault, pneumatics::Fault::kSensor);
  EXPECT_LT(score.told_after_s, 0.1);
  EXPECT_TRUE(score.safe);
}

TEST(PressureSection, TellsWhatIsReachedAndWhatIsMissed) {
  PressureCheck check;
  HoldScore hold;
  hold.settled = true;
  hold.worst_bar = 0.04;
  hold.shortest_on_s = hold.shortest_off_s = std::numeric_limits<double>::infinity();
  check.holds = {hold};
  check.faults = {
      {Breakage::kSensorHigh, pneumatics::Fault::kSensor, 0.05, 4.0, true},
      {Breakage::kNothing, pneumatics::Fault::kNone, 0.0, 4.0, false},
  };
  report::Section section = MakePressureSection(check, RigManager());
  report::CheckSection(section);
  for (const report::Comparison& line : section.comparisons) EXPECT_EQ(line.met, true) << line.name;

  check.holds[0].worst_bar = 0.06;
  check.holds[0].reversals = 10;
  check.holds[0].shortest_on_s = -0.1;
  check.holds[0].fault = pneumatics::Fault::kLeak;
  check.faults[0].safe = false;
  section = MakePressureSection(check, RigManager());
  for (const report::Comparison& line : section.comparisons)
    EXPECT_EQ(line.met, false) << line.name;
}

TEST(PressureSection, AFaultOfAnotherNameIsMissed) {
  PressureCheck check;
  check.faults = {{Breakage::kLeak, pneumatics::Fault::kSensor, 0.05, 4.0, true}};
  const report::Section section = MakePressureSection(check, RigManager());
  EXPECT_EQ(section.comparisons.back().met, false);
}

}  // namespace
}  // namespace sinew::check

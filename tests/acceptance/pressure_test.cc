// What the pressure manager must reach on the surrogate's air supply. Oracle: the surrogate's true
// pressure, breakages whose name is known.
#include "bench/acceptance/pressure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "tests/acceptance/acceptance.h"

namespace sinew::acceptance {
namespace {

pneumatics::ManagerConfig RigManager() {
  return pneumatics::LoadPneumatics(std::string(SINEW_SOURCE_DIR) + "/robots/rig/pneumatics.yaml")
      .joints.at(0);
}

std::string Name(const HoldCase& at) {
  return std::string(at.hold_with == pneumatics::HoldWith::kReservoir ? "reservoir" : "chamber") +
         ", " + std::to_string(at.from_bar) + " to " + std::to_string(at.target_bar) + " bar, " +
         std::to_string(at.target_stiffness_Nm_rad) + " Nm/rad" +
         (at.moving ? ", link moving" : "");
}

TEST(PressureAcceptance, PressuresAreHeldRelaysSparedAndBreakagesReported) {
  const PressureCheck check = MeasurePressure(RigManager(), Quick(), 1);
  ASSERT_FALSE(check.holds.empty());
  for (const HoldScore& hold : check.holds) {
    const std::string name = Name(hold.at);
    ASSERT_TRUE(hold.settled) << name;
    EXPECT_LE(hold.worst_bar, kBand_bar) << name;
    // A whole number of them in the time that is measured.
    EXPECT_LE(hold.reversals, std::ceil(kMostReversals_per_min * hold.at.seconds / 60.0))
        << name << ": fillings that follow a venting and the other way";
    EXPECT_GE(hold.least_margin_s(), kLeastMargin_s) << name << ": a relay's least time, s";
    EXPECT_EQ(hold.fault, pneumatics::Fault::kNone)
        << name << ": " << pneumatics::FaultText(hold.fault);
  }
  ASSERT_EQ(check.faults.size(), Breakages().size());
  for (const FaultScore& fault : check.faults) {
    EXPECT_TRUE(IsRight(fault)) << BreakageTitle(fault.breakage) << ": reported as "
                                << pneumatics::FaultText(fault.fault) << " after "
                                << fault.reported_after_s << " s, safe " << fault.safe;
  }
}

TEST(PressureAcceptance, AStiffnessIsHeldThroughTheIdentifiedTable) {
  const HoldScore score =
      RunHoldCase(RigManager(), {.target_stiffness_Nm_rad = 15.42, .seconds = 12.0});
  EXPECT_NEAR(score.target_bar, 3.0, 1e-6);
  EXPECT_TRUE(score.settled);
}

TEST(PressureAcceptance, AnUnknownStiffnessIsNotHeld) {
  const HoldScore score =
      RunHoldCase(RigManager(), {.target_stiffness_Nm_rad = 100.0, .seconds = 1.0});
  EXPECT_FALSE(score.settled);
}

TEST(PressureAcceptance, ABrokenSensorIsReportedAtOnceAndSafe) {
  const FaultScore score = RunFaultCase(RigManager(), Breakage::kSensorBroken);
  EXPECT_EQ(score.fault, pneumatics::Fault::kSensor);
  EXPECT_LT(score.reported_after_s, 0.1);
  EXPECT_TRUE(score.safe);
}

// Scores of known content.
TEST(PressureAcceptance, AFaultOfAnotherNameIsNotRightNorOneThatIsNotSafe) {
  EXPECT_TRUE(IsRight({Breakage::kSensorHigh, pneumatics::Fault::kSensor, 0.05, 4.0, true}));
  EXPECT_TRUE(IsRight({Breakage::kNothing, pneumatics::Fault::kNone, 0.0, 4.0, false}));
  EXPECT_FALSE(IsRight({Breakage::kLeak, pneumatics::Fault::kSensor, 0.05, 4.0, true}));
  EXPECT_FALSE(IsRight({Breakage::kSensorHigh, pneumatics::Fault::kSensor, 0.05, 4.0, false}));
  EXPECT_FALSE(IsRight({Breakage::kNothing, pneumatics::Fault::kLeak, 0.05, 4.0, true}));
}

}  // namespace
}  // namespace sinew::acceptance

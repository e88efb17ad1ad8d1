#include "components/identify/run.h"

#include <gtest/gtest.h>

namespace sinew::identify {
namespace {

TEST(Run, EverySignalHasANameThatLeadsBackToIt) {
  EXPECT_EQ(AllSignals().size(), 15u);
  for (const Signal signal : AllSignals()) {
    ASSERT_TRUE(SignalFromName(SignalName(signal)).has_value()) << SignalName(signal);
    EXPECT_EQ(*SignalFromName(SignalName(signal)), signal);
    EXPECT_FALSE(SignalUnit(signal, effects::JointKind::kRotary).empty());
  }
  EXPECT_FALSE(SignalFromName("speed").has_value());
}

TEST(Run, LinearJointsReadMetresAndNewtons) {
  EXPECT_EQ(SignalUnit(Signal::kPosition, effects::JointKind::kLinear), "m");
  EXPECT_EQ(SignalUnit(Signal::kTorque, effects::JointKind::kLinear), "N");
  EXPECT_EQ(SignalUnit(Signal::kMotorPosition, effects::JointKind::kLinear), "rad");
}

TEST(Run, AMissingSignalIsNamedWithItsRun) {
  identify::Run run;
  run.name = "a.csv";
  try {
    run.At(Signal::kMotorCurrent);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("motor_current"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("a.csv"), std::string::npos);
  }
}

}  // namespace
}  // namespace sinew::identify

// The limits of the pure types against those of the topics.
#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/reference.h>

#include <array>
#include <tuple>
#include <type_traits>

#include "components/base/types/control_mode.h"
#include "components/base/types/joints.h"
#include "components/base/types/regime.h"
#include "components/base/types/robot_state.h"

namespace sinew::types {
namespace {

template <typename Field>
constexpr std::size_t LengthOf(const Field&) {
  return std::tuple_size_v<std::decay_t<Field>>;
}

TEST(Joints, TheLimitIsTheLengthOfTheArraysInTheTopics) {
  constexpr auto kLimit = static_cast<std::size_t>(kMaxJoints);
  EXPECT_EQ(LengthOf(msg::JointState().position_rad), kLimit);
  EXPECT_EQ(LengthOf(msg::JointCommand().motor_torque_Nm), kLimit);
  EXPECT_EQ(LengthOf(msg::ActuatorState().chamber_pressure_bar), kLimit);
  EXPECT_EQ(LengthOf(msg::ValveCommand().valve_open), kLimit);
  EXPECT_EQ(LengthOf(msg::Reference().position_rad), kLimit);
}

TEST(Joints, AnArrayHasAnEntryForEachJoint) {
  EXPECT_EQ(JointArray<double>{}.size(), static_cast<std::size_t>(kMaxJoints));
  EXPECT_TRUE((std::is_same_v<JointArray<bool>::value_type, bool>));
}

// What a value is before anybody set it: the harmless one.
TEST(Types, TheFirstValueIsTheSafeOne) {
  EXPECT_EQ(ControlMode{}, ControlMode::kIdle);
  EXPECT_EQ(RobotState{}, RobotState::kDisarmed);
  EXPECT_EQ(Regime{}, Regime::kUnknown);
}

TEST(Types, PeopleReadTheNamesOfTheIdlWithoutTheWordsThatAllShare) {
  EXPECT_STREQ(NameOf(RobotState::kEstopped), "estopped");
  EXPECT_STREQ(NameOf(msg::MotionKind::kPushAgainstChamber), "push_against_chamber");
  EXPECT_STREQ(NameOf(static_cast<RobotState>(7)), "unknown");
}

}  // namespace
}  // namespace sinew::types

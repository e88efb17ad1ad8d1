#include "components/topics/wire/wire.h"

#include <gtest/gtest.h>

#include <vector>

#include "components/topics/wire/component_state.h"

namespace sinew::wire {
namespace {

// Every named value of a type, with the number that idl/ gives it: its place in the enumeration.
template <class Type>
void ExpectNumbersOnTheWire(const std::vector<Type>& types) {
  for (std::size_t number = 0; number < types.size(); ++number) {
    EXPECT_EQ(static_cast<std::size_t>(ToWire(types[number])), number);
    EXPECT_EQ(FromWire(ToWire(types[number])), types[number]) << number;
  }
}

TEST(Wire, NumbersAreThoseOfTheIdlAndTranslateBothWays) {
  using types::ControlMode;
  using types::JointKind;
  using types::Motion;
  using types::OperatorAction;
  using types::Origin;
  using types::Regime;
  using types::RobotState;
  ExpectNumbersOnTheWire<Origin>({Origin::kLive, Origin::kSim, Origin::kReplay});
  ExpectNumbersOnTheWire<RobotState>({RobotState::kDisarmed, RobotState::kArmed,
                                      RobotState::kDamped, RobotState::kFault,
                                      RobotState::kEstopped});
  ExpectNumbersOnTheWire<ControlMode>(
      {ControlMode::kIdle, ControlMode::kTorque, ControlMode::kPosition, ControlMode::kVelocity});
  ExpectNumbersOnTheWire<JointKind>({JointKind::kRotary, JointKind::kLinear});
  ExpectNumbersOnTheWire<Regime>({Regime::kUnknown, Regime::kSea, Regime::kPea});
  ExpectNumbersOnTheWire<Motion>(
      {Motion::kNone, Motion::kHold, Motion::kMoveSlowly, Motion::kPushAgainstChamber});
  ExpectNumbersOnTheWire<OperatorAction>({OperatorAction::kDisarm, OperatorAction::kArm,
                                          OperatorAction::kEstop, OperatorAction::kReset,
                                          OperatorAction::kStart, OperatorAction::kStop});
}

TEST(Wire, CausesOfFaultsStandInOneOrder) {
  using types::FaultCause;
  EXPECT_EQ(ToWire(FaultCause::kNone), msg::FAULT_NONE);
  EXPECT_EQ(ToWire(FaultCause::kCommandMissing), msg::FAULT_COMMAND_MISSING);
  EXPECT_EQ(ToWire(FaultCause::kCommandNotFinite), msg::FAULT_COMMAND_NOT_FINITE);
  EXPECT_EQ(ToWire(FaultCause::kPlant), msg::FAULT_PLANT);
  EXPECT_EQ(ToWire(FaultCause::kEstimatesLost), msg::FAULT_ESTIMATES_LOST);
  EXPECT_EQ(ToWire(FaultCause::kOverspeed), msg::FAULT_OVERSPEED);
  EXPECT_EQ(ToWire(FaultCause::kZero), msg::FAULT_ZERO);
  EXPECT_EQ(ToWire(FaultCause::kEncoderFrozen), msg::FAULT_ENCODER_FROZEN);
  const types::Fault fault{FaultCause::kAnotherMaster, 3, 1.5, 1.0};
  EXPECT_EQ(FromWire(ToWire(fault)), fault);
}

TEST(Wire, ANumberWithoutANameLetsTheRobotDoLeast) {
  EXPECT_EQ(FromWire(static_cast<msg::Origin>(7)), types::Origin::kReplay) << "never live";
  EXPECT_EQ(FromWire(static_cast<msg::RobotState>(7)), types::RobotState::kFault);
  EXPECT_EQ(FromWire(static_cast<msg::CommandMode>(7)), types::ControlMode::kIdle);
  EXPECT_EQ(FromWire(static_cast<msg::JointKind>(7)), types::JointKind::kRotary);
  EXPECT_EQ(FromWire(static_cast<msg::RegimeKind>(7)), types::Regime::kUnknown);
  EXPECT_EQ(FromWire(static_cast<msg::MotionKind>(7)), types::Motion::kNone);
  EXPECT_EQ(FromWire(static_cast<msg::OperatorAction>(70)), std::nullopt);
  msg::Fault fault;
  fault.cause(static_cast<msg::FaultCause>(70));
  EXPECT_EQ(FromWire(fault).cause, types::FaultCause::kPlant) << "a fault all the same";
}

TEST(Wire, StatesOfAComponentHaveNames) {
  EXPECT_STREQ(NameOf(msg::COMPONENT_CONFIGURED), "configured");
  EXPECT_STREQ(NameOf(msg::COMPONENT_ACTIVE), "active");
  EXPECT_STREQ(NameOf(msg::COMPONENT_FAULT), "fault");
  EXPECT_STREQ(NameOf(msg::COMPONENT_STOPPED), "stopped");
  EXPECT_STREQ(NameOf(static_cast<msg::ComponentState>(7)), "unknown");
}

TEST(Wire, AHeaderTranslatesBothWays) {
  const types::MessageHeader header{.session_id = 0xFEDCBA9876543210u,
                                    .tick = 17,
                                    .origin = types::Origin::kReplay,
                                    .stamp_ns = -5};
  const msg::Header message = ToWire(header);
  EXPECT_EQ(message.session_id(), 0xFEDCBA9876543210u);
  EXPECT_EQ(message.tick(), 17u);
  EXPECT_EQ(message.origin(), msg::ORIGIN_REPLAY);
  EXPECT_EQ(message.stamp_ns(), -5);
  const types::MessageHeader back = FromWire(message);
  EXPECT_EQ(back.session_id, header.session_id);
  EXPECT_EQ(back.tick, header.tick);
  EXPECT_EQ(back.origin, header.origin);
  EXPECT_EQ(back.stamp_ns, header.stamp_ns);
}

}  // namespace
}  // namespace sinew::wire

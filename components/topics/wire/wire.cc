#include "components/topics/wire/wire.h"

#include <array>

namespace sinew::wire {
namespace {

template <class Type, class Wire>
struct Pair {
  Type type;
  Wire wire;
};
template <class Type, class Wire>
Pair(Type, Wire) -> Pair<Type, Wire>;  // clang 14 does not derive it

// One table for both directions of a type.
constexpr std::array kOrigin = {
    Pair{types::Origin::kLive, msg::ORIGIN_LIVE},
    Pair{types::Origin::kSim, msg::ORIGIN_SIM},
    Pair{types::Origin::kReplay, msg::ORIGIN_REPLAY},
};
constexpr std::array kRobotState = {
    Pair{types::RobotState::kDisarmed, msg::ROBOT_DISARMED},
    Pair{types::RobotState::kArmed, msg::ROBOT_ARMED},
    Pair{types::RobotState::kDamped, msg::ROBOT_DAMPED},
    Pair{types::RobotState::kFault, msg::ROBOT_FAULT},
    Pair{types::RobotState::kEstopped, msg::ROBOT_ESTOPPED},
};
constexpr std::array kControlMode = {
    Pair{types::ControlMode::kIdle, msg::COMMAND_IDLE},
    Pair{types::ControlMode::kTorque, msg::COMMAND_TORQUE},
    Pair{types::ControlMode::kPosition, msg::COMMAND_POSITION},
    Pair{types::ControlMode::kVelocity, msg::COMMAND_VELOCITY},
};
constexpr std::array kJointKind = {
    Pair{types::JointKind::kRotary, msg::JOINT_REVOLUTE},
    Pair{types::JointKind::kLinear, msg::JOINT_PRISMATIC},
};
constexpr std::array kRegime = {
    Pair{types::Regime::kUnknown, msg::REGIME_UNKNOWN},
    Pair{types::Regime::kSea, msg::REGIME_SEA},
    Pair{types::Regime::kPea, msg::REGIME_PEA},
};
constexpr std::array kMotion = {
    Pair{types::Motion::kNone, msg::MOTION_NONE},
    Pair{types::Motion::kHold, msg::MOTION_HOLD},
    Pair{types::Motion::kMoveSlowly, msg::MOTION_MOVE_SLOWLY},
    Pair{types::Motion::kPushAgainstChamber, msg::MOTION_PUSH_AGAINST_CHAMBER},
};
constexpr std::array kOperatorAction = {
    Pair{types::OperatorAction::kDisarm, msg::OPERATOR_DISARM},
    Pair{types::OperatorAction::kArm, msg::OPERATOR_ARM},
    Pair{types::OperatorAction::kEstop, msg::OPERATOR_ESTOP},
    Pair{types::OperatorAction::kReset, msg::OPERATOR_RESET},
    Pair{types::OperatorAction::kStart, msg::OPERATOR_START},
    Pair{types::OperatorAction::kStop, msg::OPERATOR_STOP},
    Pair{types::OperatorAction::kHandover, msg::OPERATOR_HANDOVER},
    Pair{types::OperatorAction::kPermitReplay, msg::OPERATOR_PERMIT_REPLAY},
};

// The fallback is for values that are not in the table: no enumerator of the project's own types is
// missing there.
template <class Table, class Type, class Wire>
Wire WireOf(const Table& table, Type type, Wire fallback) noexcept {
  for (const auto& pair : table) {
    if (pair.type == type) return pair.wire;
  }
  return fallback;
}

template <class Table, class Wire, class Type>
Type TypeOf(const Table& table, Wire wire, Type fallback) noexcept {
  for (const auto& pair : table) {
    if (pair.wire == wire) return pair.type;
  }
  return fallback;
}

}  // namespace

msg::Origin ToWire(types::Origin origin) noexcept {
  return WireOf(kOrigin, origin, msg::ORIGIN_REPLAY);
}

msg::RobotState ToWire(types::RobotState state) noexcept {
  return WireOf(kRobotState, state, msg::ROBOT_FAULT);
}

msg::CommandMode ToWire(types::ControlMode mode) noexcept {
  return WireOf(kControlMode, mode, msg::COMMAND_IDLE);
}

msg::JointKind ToWire(types::JointKind kind) noexcept {
  return WireOf(kJointKind, kind, msg::JOINT_REVOLUTE);
}

msg::RegimeKind ToWire(types::Regime regime) noexcept {
  return WireOf(kRegime, regime, msg::REGIME_UNKNOWN);
}

msg::MotionKind ToWire(types::Motion motion) noexcept {
  return WireOf(kMotion, motion, msg::MOTION_NONE);
}

msg::OperatorAction ToWire(types::OperatorAction action) noexcept {
  return WireOf(kOperatorAction, action, msg::OPERATOR_STOP);
}

types::Origin FromWire(msg::Origin origin) noexcept {
  return TypeOf(kOrigin, origin, types::Origin::kReplay);
}

types::RobotState FromWire(msg::RobotState state) noexcept {
  return TypeOf(kRobotState, state, types::RobotState::kFault);
}

types::ControlMode FromWire(msg::CommandMode mode) noexcept {
  return TypeOf(kControlMode, mode, types::ControlMode::kIdle);
}

types::JointKind FromWire(msg::JointKind kind) noexcept {
  return TypeOf(kJointKind, kind, types::JointKind::kRotary);
}

types::Regime FromWire(msg::RegimeKind regime) noexcept {
  return TypeOf(kRegime, regime, types::Regime::kUnknown);
}

types::Motion FromWire(msg::MotionKind motion) noexcept {
  return TypeOf(kMotion, motion, types::Motion::kNone);
}

std::optional<types::OperatorAction> FromWire(msg::OperatorAction action) noexcept {
  for (const auto& pair : kOperatorAction) {
    if (pair.wire == action) return pair.type;
  }
  return std::nullopt;
}

// The causes stand in both in one order.
static_assert(static_cast<int>(msg::FAULT_ANOTHER_MASTER) + 1 == types::kFaultCauses);

msg::FaultCause ToWire(types::FaultCause cause) noexcept {
  return static_cast<msg::FaultCause>(cause);
}

msg::Fault ToWire(const types::Fault& fault) noexcept {
  msg::Fault message;
  message.cause(ToWire(fault.cause));
  message.joint(static_cast<std::uint8_t>(fault.joint));
  message.value(fault.value);
  message.limit(fault.limit);
  return message;
}

types::Fault FromWire(const msg::Fault& fault) noexcept {
  const auto cause = static_cast<std::uint32_t>(fault.cause());
  const bool known = cause < static_cast<std::uint32_t>(types::kFaultCauses);
  return {.cause = known ? static_cast<types::FaultCause>(cause) : types::FaultCause::kPlant,
          .joint = fault.joint(),
          .value = fault.value(),
          .limit = fault.limit()};
}

msg::Header ToWire(const types::MessageHeader& header) noexcept {
  msg::Header message;
  message.session_id(header.session_id);
  message.tick(header.tick);
  message.stamp_ns(header.stamp_ns);
  message.origin(ToWire(header.origin));
  return message;
}

types::MessageHeader FromWire(const msg::Header& header) noexcept {
  return {.session_id = header.session_id(),
          .tick = header.tick(),
          .origin = FromWire(header.origin()),
          .stamp_ns = header.stamp_ns()};
}

}  // namespace sinew::wire

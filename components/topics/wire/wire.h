// Translation between the messages of the topics (idl/, namespace msg) and the types of the project
// (components/base/types): once for each type that more than one participant reads or writes.
//
// ToWire and FromWire are inverses for all values that have a name. A number without a name, from a
// damaged or foreign message, becomes the value that lets the robot do least: see each function.
// Any thread; nothing allocates or throws.
#pragma once

#include <sinew_idl/fault.h>
#include <sinew_idl/header.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/regime.h>

#include <optional>

#include "components/base/types/control_mode.h"
#include "components/base/types/fault.h"
#include "components/base/types/joint_kind.h"
#include "components/base/types/message_header.h"
#include "components/base/types/motion.h"
#include "components/base/types/operator_action.h"
#include "components/base/types/regime.h"
#include "components/base/types/robot_state.h"

namespace sinew::wire {

msg::Origin ToWire(types::Origin origin) noexcept;
msg::RobotState ToWire(types::RobotState state) noexcept;
msg::CommandMode ToWire(types::ControlMode mode) noexcept;
msg::JointKind ToWire(types::JointKind kind) noexcept;
msg::RegimeKind ToWire(types::Regime regime) noexcept;
msg::MotionKind ToWire(types::Motion motion) noexcept;
msg::OperatorAction ToWire(types::OperatorAction action) noexcept;
msg::FaultCause ToWire(types::FaultCause cause) noexcept;
msg::Fault ToWire(const types::Fault& fault) noexcept;

types::Origin FromWire(msg::Origin origin) noexcept;          // without a name: kReplay
types::RobotState FromWire(msg::RobotState state) noexcept;   // without a name: kFault
types::ControlMode FromWire(msg::CommandMode mode) noexcept;  // without a name: kIdle
types::JointKind FromWire(msg::JointKind kind) noexcept;      // without a name: kRotary
types::Regime FromWire(msg::RegimeKind regime) noexcept;      // without a name: kUnknown
types::Motion FromWire(msg::MotionKind motion) noexcept;      // without a name: kNone
types::Fault FromWire(const msg::Fault& fault) noexcept;      // without a name: kPlant
// Nothing for a number without a name: no action.
std::optional<types::OperatorAction> FromWire(msg::OperatorAction action) noexcept;

msg::Header ToWire(const types::MessageHeader& header) noexcept;
types::MessageHeader FromWire(const msg::Header& header) noexcept;

}  // namespace sinew::wire

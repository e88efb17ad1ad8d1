// Messages to and from the reference generator.
#pragma once

#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include "components/node/tick_loop.h"
#include "components/reference/robot_reference.h"

namespace sinew::reference {

// The spans of the result point into `state`.
RobotReferenceInput ToInput(const node::Tick& tick, const msg::JointState& state);
// Start and stop commands of the operator in the running session since the last tick.
void AddOperatorCommands(node::Reader<msg::OperatorCommand>& commands, RobotReferenceInput* input);
// What a standby follows.
RobotReferenceOutput FromMessage(const msg::Reference& message);
msg::Reference ToMessage(const RobotReferenceOutput& output, const node::Tick& tick);

}  // namespace sinew::reference

// Messages to and from the reference generator.
#pragma once

#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include "components/robot/reference/robot_reference.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::reference {

// The spans of the result point into `state`.
RobotReferenceInput ToInput(const node::Tick& tick, const msg::JointState& state);
// The reference that a standby follows.
RobotReferenceOutput FromMessage(const msg::Reference& message);

// Start and stop commands of the operator.
class OperatorStarts {
 public:
  explicit OperatorStarts(node::Node& node);
  // Those that came since the last tick and count in the running session, whose state provider has
  // this origin; the loop's outputs name them.
  void AddTo(RobotReferenceInput* input, types::Origin origin, node::TickLoop* loop);
  std::uint64_t refused() const { return gate_.refused(); }

 private:
  node::Reader<msg::OperatorCommand> commands_;
  node::CommandGate gate_{"operator's start or stop"};
};

msg::Reference ToMessage(const RobotReferenceOutput& output, const node::Tick& tick);

}  // namespace sinew::reference

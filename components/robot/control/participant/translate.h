// Messages to and from the robot controller.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>

#include <string>

#include "components/robot/control/file/control_file.h"
#include "components/robot/control/follower.h"
#include "components/robot/control/robot_controller.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::control {

// The inputs that the configured strategies need, gathered tick by tick.
class ControlInputs {
 public:
  ControlInputs(node::Node& node, node::TickLoop& loop, const ControlConfig& config);

  RobotInput Gather(const node::Tick& tick);
  // Operator's resets and motion requests that do not count (components/base/types/command_rule.h).
  std::uint64_t refused() const {
    return reset_gate_.refused() + (motion_ != nullptr ? motion_->refused() : 0);
  }
  // Before a step: takes another controller's commands that the robot got instead of the own ones.
  void FollowOwner(const node::Tick& tick, RobotController* controller);
  // After it: the own command of this tick.
  void Made(const node::Tick& tick, const msg::JointCommand& command);
  void Exchange(types::StateArchive& archive);  // types/state_archive.h
  msg::JointCommand ToMessage(const RobotOutput& output, const RobotInput& input) const;

 private:
  void TakeOperatorCommands(const node::Tick& tick);
  node::TickLoop& loop_;
  ControlConfig config_;
  node::TickInput<msg::JointState>& state_;
  node::TickInput<msg::Reference>& reference_;
  node::TickInput<msg::ActuatorState>* actuator_ = nullptr;
  node::TickInput<msg::TorquePrediction>* prediction_ = nullptr;
  node::TickInput<msg::RegimeState>* regime_ = nullptr;
  node::TickInput<msg::MotionRequest>* motion_ = nullptr;
  node::Reader<msg::OperatorCommand> operator_;
  node::OtherOwner<msg::JointCommand> owner_;
  Follower follower_;
  node::CommandGate reset_gate_{"reset"};
  bool estopped_ = false;
  bool stands_by_ = true;  // RobotInput
};

// One line about a fault; empty: none.
std::string FaultLine(const RobotOutput& output);

}  // namespace sinew::control

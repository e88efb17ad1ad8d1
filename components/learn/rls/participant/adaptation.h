// One tick of sinew-rls: messages in, messages out.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>

#include "components/learn/rls/adapter.h"
#include "components/learn/rls/file/rls_config.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::rls {

// joint_state is the trigger. Features and command are those of the tick before: the target is what
// the motor did with that command.
struct Inputs {
  explicit Inputs(node::TickLoop& loop)
      : state(loop.AddInput(node::kJointState)),
        actuator(loop.AddInput(node::kActuatorState)),
        reservoir(loop.AddInput(node::kReservoirState, {.delay_ticks = 1})),
        command(loop.AddInput(node::kJointCommand, {.delay_ticks = 1})) {}

  node::TickInput<msg::JointState>& state;
  node::TickInput<msg::ActuatorState>& actuator;
  node::TickInput<msg::ReservoirState>& reservoir;
  node::TickInput<msg::JointCommand>& command;
};

struct Outputs {
  msg::Readout readout;
  msg::AdaptationState adaptation;
};

class Adaptation {
 public:
  explicit Adaptation(const RlsConfig& config);  // throws UsageError

  // A standby's, before Step: the owner's readout, from which this one goes on.
  void Follow(const msg::Readout& owner, const node::Tick& tick);
  Outputs Step(const Inputs& inputs, const node::Tick& tick);

  std::uint64_t updates() const { return updates_; }
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

 private:
  void StartSession(const node::Tick& tick);
  TickData Read(const Inputs& inputs, const node::Tick& tick);
  double DriveTorque(std::size_t joint, const msg::ActuatorState& actuator,
                     const msg::JointCommand& command) const;

  actuator::RobotModel robot_;
  TorqueFrom torque_from_;
  TargetEquation equation_;
  Adapter adapter_;
  Eigen::VectorXd features_;
  std::uint64_t session_id_ = 0;
  std::uint64_t updates_ = 0;
};

}  // namespace sinew::rls

// Demands on the pressure managers of a robot: standing targets, requests, motion requests, and
// whether pressure may be held at all.
#pragma once

#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>

#include <vector>

#include "components/base/types/joints.h"
#include "components/base/types/robot_state.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/pneumatics/manager.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::pneumatics {

class PressureRequests {
 public:
  // Adds motion_request to the loop where the configuration asks for it.
  PressureRequests(node::Node& node, node::TickLoop& loop, const PneumaticsConfig& config);

  // Takes what has arrived and gives the managers (one a joint) their targets. A new session starts
  // from the configuration. True: the session is new.
  // origin: the state provider's, which decides what counts (components/base/types/command_rule.h).
  bool Take(const node::Tick& tick, types::Origin origin, std::vector<PressureManager>* managers);
  bool MayHold(types::RobotState state) const;
  // Another manager is the owner: its targets are followed.
  bool standby() const { return standby_; }
  std::uint64_t refused() const { return stiffness_gate_.refused() + reset_gate_.refused(); }
  void Exchange(types::StateArchive& archive);  // types/state_archive.h
  bool reset() const { return reset_; }         // an operator's reset came with this tick

 private:
  void TakeStiffness(const types::RunningSession& running, std::vector<PressureManager>* managers);
  void FollowOwner(const node::Tick& tick, bool asked);
  void TakeOperator(const types::RunningSession& running);

  node::TickLoop& loop_;
  PneumaticsConfig config_;
  types::JointArray<double> standing_target_bar_{};  // without motion requests
  node::TickInput<msg::MotionRequest>* motion_ = nullptr;
  node::Reader<msg::StiffnessRequest> requests_;
  node::Reader<msg::OperatorCommand> operator_;
  node::OtherOwner<msg::PneumaticState> owner_;
  node::CommandGate stiffness_gate_{"stiffness_request"};
  node::CommandGate reset_gate_{"reset"};
  bool estopped_ = false;
  bool reset_ = false;
  bool standby_ = false;
  std::uint64_t session_id_ = 0;
};

}  // namespace sinew::pneumatics

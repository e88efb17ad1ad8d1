// Messages to and from the pressure managers of all joints.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/pneumatics.h>

#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/pneumatics/manager.h"
#include "components/robot/pneumatics/participant/requests.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::pneumatics {

class RobotPneumatics {
 public:
  RobotPneumatics(node::Node& node, node::TickLoop& loop, const PneumaticsConfig& config);

  void Step(const node::Tick& tick);
  msg::ValveCommand Command() const;
  msg::PneumaticState State(const node::Tick& tick) const;
  // The first trouble and its joint, one line; empty: none.
  std::string Trouble() const;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

 private:
  std::vector<PressureManager> managers_;
  types::JointArray<ManagerOutput> output_{};
  node::TickInput<msg::JointState>& state_;
  node::TickInput<msg::ActuatorState>& actuator_;
  PressureRequests requests_;
};

}  // namespace sinew::pneumatics

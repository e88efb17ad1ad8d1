// Messages to and from the regime detectors of all joints.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/regime.h>

#include <string>
#include <vector>

#include "components/node/tick_loop.h"
#include "components/regime/detector.h"
#include "components/types/joints.h"

namespace sinew::regime {

struct RobotRegime {
  std::vector<RegimeDetector> detectors;
  types::JointArray<DetectorOutput> output{};
  bool stale = false;

  explicit RobotRegime(const std::vector<DetectorConfig>& joints);
  void Step(const node::Tick& tick, const msg::JointState& state,
            const node::TickInput<msg::ActuatorState>& actuator);
  // What is wrong with which joint, one line; empty: nothing.
  std::string Trouble() const;
};

msg::RegimeState ToMessage(const RobotRegime& robot, const node::Tick& tick);
msg::MotionRequest ToRequest(const RobotRegime& robot);

}  // namespace sinew::regime

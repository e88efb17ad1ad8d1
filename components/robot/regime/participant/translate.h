// Messages to and from the regime detectors of all joints.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/regime.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/robot/regime/detector.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::regime {

struct RobotRegime {
  std::vector<RegimeDetector> detectors;
  types::JointArray<DetectorOutput> output{};
  bool stale = false;
  bool standby = false;

  explicit RobotRegime(const std::vector<DetectorConfig>& joints);
  // A standby's, before Step: the owner's setup counts here. owner_heard: another detector is the
  // owner; this one asks for no motion.
  void Follow(const node::Tick& tick, node::OtherOwner<msg::RegimeState>* owner);
  void Step(const node::Tick& tick, const msg::JointState& state,
            const node::TickInput<msg::ActuatorState>& actuator);
  // The first trouble and its joint, one line; empty: none.
  std::string Trouble() const;
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

 private:
  // motor / N - output of the last ticks, by tick: the owner's answer comes some ticks later.
  static constexpr std::size_t kTicksKept = 32;
  struct Gaps {
    std::uint64_t tick = 0;
    bool known = false;
    types::JointArray<double> gap_rad{};

    void Exchange(types::StateArchive& archive);
  };
  std::array<Gaps, kTicksKept> gaps_;
};

msg::RegimeState ToMessage(const RobotRegime& robot, const node::Tick& tick);
msg::MotionRequest ToRequest(const RobotRegime& robot);

}  // namespace sinew::regime

// Messages to and from the residual monitors of all joints.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/residual.h>

#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/robot/residual/file/residual_file.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::residual {

class RobotResidual {
 public:
  explicit RobotResidual(ResidualConfig config) : config_(std::move(config)) {}

  // A new session learns anew; ticks that never came are lost samples. A robot that does not
  // measure what the model reads, or has fewer joints, is not monitored: unfit.
  void Step(const node::Tick& tick, const msg::JointState& state,
            const node::TickInput<msg::ActuatorState>& actuator);
  msg::ResidualState ToMessage(const node::Tick& tick) const;
  // The state in one line: a joint that learns, an alarm (and what it follows, which becomes more
  // certain every second). Empty: watching.
  std::string Line(bool with_cause) const;
  bool unfit() const { return !unfit_.empty(); }

 private:
  // Why this robot cannot be monitored with the model; empty: it can.
  std::string Unfit(const msg::JointState& state, const msg::ActuatorState& actuator) const;
  void Begin(const node::Tick& tick, const msg::ActuatorState& actuator);

  ResidualConfig config_;
  std::vector<Monitor> monitors_;
  types::JointArray<MonitorOutput> output_{};
  std::uint64_t session_id_ = 0, first_tick_ = 0, last_tick_ = 0;
  double period_s_ = 0.0, time_s_ = 0.0;
  bool stale_ = false, has_motor_ = true;
  std::string unfit_;
};

}  // namespace sinew::residual

// Runs a protocol over topics: joint_state and actuator_state in, joint_command and valve_command
// out, with any state provider. The hand is sim_disturbance where the provider is a
// simulation; elsewhere a person gets the protocol's instructions.
//
// Ends when the protocol is done, the session ends, or the robot stops obeying. Leaves the robot
// idle, and disarmed if it was armed here. One thread.
#pragma once

#include <functional>
#include <string>

#include "components/model/experiment/protocol.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"

namespace sinew::experiment {

struct TopicOptions {
  int joint = 0;
  bool arm = false;      // sends `arm`; else an operator does
  double wait_s = 10.0;  // for the first joint_state
};

struct TopicProgress {
  double time_s = 0.0;
  std::string instruction{};
  bool armed = false;
  bool ready = false;  // the robot stands at the protocol's start
};

struct TopicRun {
  Recording rows;          // since the protocol's start, times from there
  double started_s = 0.0;  // its start as a stamp, s
  bool simulated = false;  // the provider is a simulation
  bool done = false;
  std::string end;  // why it ended
};

// Throws std::runtime_error: no state provider, or another participant commands the robot.
TopicRun RunOverTopics(node::Node& node, node::StopFlag& stop, Prepared& protocol,
                       const TopicOptions& options,
                       const std::function<void(const TopicProgress&)>& progress = {});

}  // namespace sinew::experiment

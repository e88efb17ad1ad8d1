// The robot that is played for a program under test: every topic that another role would write, for
// a tick. Open loop: the joints swing whatever is commanded, so equal moments give equal messages.
//
// Pure but for the encoding; any thread.
#pragma once

#include <sinew_idl/joint.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "components/topics/node/codec.h"

namespace sinew::conform {

// Contents of a played tick.
struct Moment {
  std::uint64_t session_id = 0, tick = 0;
  double period_s = 0.0;
  int joints = 1;
  msg::RobotState robot_state = msg::RobotState::kDisarmed;
  bool last_tick = false;
  bool valve_open = false;             // the contact of the valves
  bool positions_are_nan = false;      // of joint_state, marked valid
  bool reference_is_nan = false;       // positions and velocities of reference
  std::string withheld{}, replayed{};  // a topic that is not sent; one that is from a recording
  std::string foreign{};               // a topic that still comes from another session
};

// Topics that can be played.
std::vector<std::string_view> PlayedTopics();

// The message of the topic, encoded; the topic is one of PlayedTopics().
node::Bytes PlayedMessage(std::string_view topic, const Moment& moment);

}  // namespace sinew::conform

// The facts of an output that the checks look at, whatever its type.
#pragma once

#include <sinew_idl/header.h>

#include <cstdint>
#include <optional>
#include <string_view>

#include "components/topics/node/codec.h"

namespace sinew::conform {

struct Facts {
  std::uint64_t session_id = 0, tick = 0;
  msg::Origin origin{};
  std::optional<bool> stale;  // of pneumatic_state: nothing is settled; empty: has no such field
  std::optional<int> joint_count;
  bool finite = true;       // torques, positions and their derivatives of all joints in use
  bool drives = false;      // joint_command: a joint gets a torque, or is to move
  bool valve_open = false;  // valve_command: of joint 0
  node::Bytes canonical;    // the same message with alignment bytes 0
};

// Nothing: the payload is no message of this topic (components/topics/node/codec.h).
std::optional<Facts> ReadFacts(std::string_view topic, const node::Bytes& payload);

// A message of the topic with a joint_count that its arrays do not have; empty: it has no
// joint_count.
node::Bytes WithImpossibleCount(std::string_view topic, const node::Bytes& payload);

}  // namespace sinew::conform

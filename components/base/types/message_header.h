// The cycle and the session that a message belongs to (header of every topic, idl/header.idl).
#pragma once

#include <cstdint>

#include "components/base/types/robot_state.h"

namespace sinew::types {

struct MessageHeader {
  std::uint64_t session_id = 0;  // of the state provider's run
  std::uint64_t tick = 0;        // the state provider's cycle, from 0
  Origin origin = Origin::kSim;
  std::int64_t stamp_ns = 0;  // measurement of the cycle: UTC, or simulated time in lockstep
};

}  // namespace sinew::types

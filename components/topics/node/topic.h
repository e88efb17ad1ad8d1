// A topic: its name, its message type and its QoS profile. Needs no DDS.
#pragma once

#include <string_view>

namespace sinew::node {

// QoS of a topic in real time; in lockstep every topic but the latched ones uses `lockstep`.
enum class Profile {
  kState,     // BEST_EFFORT, KEEP_LAST 1: the newest sample is the only one that matters
  kControl,   // as kState, EXCLUSIVE ownership with a deadline: one writer at a time (ownership.h)
  kEvent,     // RELIABLE, KEEP_LAST 16, volatile: requests and arm
  kLatched,   // RELIABLE, TRANSIENT_LOCAL, KEEP_LAST 1 per key: status
  kLog,       // readers of recorders: RELIABLE where offered, KEEP_ALL
  kLockstep,  // RELIABLE, TRANSIENT_LOCAL, KEEP_LAST 256, no wall-clock QoS: nothing dropped; of
              // the log in real time, too
};

std::string_view ProfileName(Profile profile);

// One writer is heard at a time.
constexpr bool IsExclusive(Profile profile) noexcept { return profile == Profile::kControl; }

template <class Message>
struct Topic {
  std::string_view name;
  Profile profile;
};

// Whether the message begins with its header (session, tick, stamp, origin), as every topic's but
// component_status does. Only such messages can be inputs of a TickLoop.
template <class Message>
inline constexpr bool kBeginsWithHeader = true;

}  // namespace sinew::node

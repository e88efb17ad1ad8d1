// The ticks of a running session, from its joint_state.
//
// Threads: DDS appends, the player's thread takes.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "components/topics/node/node.h"

namespace sinew::logger {

struct LiveTick {
  std::uint64_t session_id;
  std::uint64_t tick;
  std::int64_t stamp_ns;
  bool last;  // the session ends with it
};

class LiveTicks {
 public:
  explicit LiveTicks(node::Node& node);  // reads joint_state from here on
  std::optional<LiveTick> TakeNext();    // the oldest

 private:
  struct Shared {
    std::mutex mutex;
    std::deque<LiveTick> ticks;
  };
  const std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

}  // namespace sinew::logger

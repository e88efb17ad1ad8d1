// Replies that bound how far the player, as the state provider, runs ahead of its readers.
//
// Thread: the player's; DDS threads only store the newest tick of a reply.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "components/record/logger/player/playlist.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"

namespace sinew::logger {

class Answers {
 public:
  // Texts TOPIC or TOPIC:WINDOW, the window in ticks from 0 to 128. Throws UsageError.
  Answers(node::Node& node, const node::StopFlag& stop, const std::vector<std::string>& topics,
          double timeout_s);

  // Before a joint_state goes out: waits until every topic has a reply to the tick `window` ticks
  // before the last one sent. False: stop was requested. Throws std::runtime_error when a reply
  // does not come within the timeout.
  bool WaitBefore(const PlayedMessage& next);

 private:
  struct Awaited {
    std::string topic;
    std::size_t window = 0;
    std::shared_ptr<std::atomic<std::uint64_t>> answered;  // newest tick + 1
    std::shared_ptr<std::atomic<std::uint64_t>> session;
  };
  void Add(const std::string& text);

  node::Node& node_;
  const node::StopFlag& stop_;
  const double timeout_s_;
  std::vector<Awaited> awaited_;
  std::deque<std::uint64_t> sent_ticks_;
  std::uint64_t sent_session_ = 0;
};

}  // namespace sinew::logger

// Lockstep: a tick ends when every awaited topic has answered it, or is at most its window behind.
//
// Knows topics by functions only, so that it needs no DDS. Thread: the provider's loop; the
// functions are called in it.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace sinew::provider {

struct AwaitedTopic {
  std::string topic;
  std::uint64_t window = 0;  // ticks that the answers may lag
  // One more than the newest tick that was answered; 0: none.
  std::function<std::uint64_t()> answers;
  // Blocks until something arrived or the timeout is over.
  std::function<void(std::chrono::microseconds)> wait;
};

// "joint_command" or "recording_progress:128": topic and window; the functions are left empty.
// Throws UsageError: no such topic, a window that is not a number from 0 to 128.
AwaitedTopic ParseAwaited(const std::string& text);

class LockstepWait {
 public:
  LockstepWait(std::vector<AwaitedTopic> topics, double timeout_s)
      : topics_(std::move(topics)), timeout_s_(timeout_s) {}

  struct Caller {
    std::function<void()> take;     // takes what has arrived
    std::function<bool()> stopped;  // stop was requested
  };
  // Until every topic has answered tick - window. False: stopped. Throws std::runtime_error that
  // names topic and tick when an answer takes longer than the timeout.
  bool Answers(std::uint64_t tick, const Caller& caller) const;
  // The same without windows: at the end of a session, until the recorders have all of it.
  bool AllAnswers(std::uint64_t tick, const Caller& caller) const;

 private:
  bool Await(const AwaitedTopic& topic, std::uint64_t tick, const Caller& caller) const;

  std::vector<AwaitedTopic> topics_;
  double timeout_s_;
};

}  // namespace sinew::provider

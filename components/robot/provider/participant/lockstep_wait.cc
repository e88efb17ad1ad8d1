#include "components/robot/provider/participant/lockstep_wait.h"

#include <stdexcept>

#include "components/base/config/config.h"
#include "components/topics/node/topics.h"

namespace sinew::provider {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int kLargestWindow = 128;
constexpr std::chrono::milliseconds kPoll{50};  // how often a stop request is looked for

}  // namespace

AwaitedTopic ParseAwaited(const std::string& text) {
  AwaitedTopic awaited;
  const std::size_t colon = text.find(':');
  awaited.topic = text.substr(0, colon);
  if (node::FindTopic(awaited.topic) == nullptr) {
    throw UsageError("--await: no topic '" + awaited.topic + "'");
  }
  if (colon == std::string::npos) return awaited;
  int window = -1;
  try {
    window = std::stoi(text.substr(colon + 1));
  } catch (const std::exception&) {
  }
  if (window < 0 || window > kLargestWindow) {
    throw UsageError("--await: '" + text +
                     "', expected TOPIC:WINDOW with a window from 0 to 128 ticks");
  }
  awaited.window = static_cast<std::uint64_t>(window);
  return awaited;
}

bool LockstepWait::Answers(std::uint64_t tick, const Caller& caller) const {
  for (const AwaitedTopic& topic : topics_) {
    if (tick < topic.window) continue;
    if (!Await(topic, tick - topic.window, caller)) return false;
  }
  return true;
}

bool LockstepWait::AllAnswers(std::uint64_t tick, const Caller& caller) const {
  for (const AwaitedTopic& topic : topics_) {
    if (!Await(topic, tick, caller)) return false;
  }
  return true;
}

bool LockstepWait::Await(const AwaitedTopic& topic, std::uint64_t tick,
                         const Caller& caller) const {
  const auto give_up = Clock::now() + std::chrono::duration<double>(timeout_s_);
  while (true) {
    caller.take();
    if (topic.answers() >= tick + 1) return true;
    if (caller.stopped()) return false;
    topic.wait(kPoll);
    if (Clock::now() > give_up) {
      throw std::runtime_error("no " + topic.topic + " for tick " + std::to_string(tick) +
                               " within " + std::to_string(static_cast<int>(timeout_s_)) +
                               " s; is its writer running, in the same domain and in lockstep?");
    }
  }
}

}  // namespace sinew::provider

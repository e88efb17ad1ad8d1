#include "components/record/logger/player/participant/answers.h"

#include <chrono>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/topics/node/codec.h"

namespace sinew::logger {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kLongestWindow = 128;

}  // namespace

Answers::Answers(node::Node& node, const node::StopFlag& stop,
                 const std::vector<std::string>& topics, double timeout_s)
    : node_(node), stop_(stop), timeout_s_(timeout_s) {
  for (const std::string& text : topics) Add(text);
}

void Answers::Add(const std::string& text) {
  Awaited awaited;
  const std::size_t colon = text.find(':');
  awaited.topic = text.substr(0, colon);
  const node::TopicInfo* topic = node::FindTopic(awaited.topic);
  if (topic == nullptr) throw UsageError("--await: no topic '" + awaited.topic + "'");
  if (colon != std::string::npos) {
    int window = -1;
    try {
      window = std::stoi(text.substr(colon + 1));
    } catch (const std::exception&) {
    }
    if (window < 0 || window > kLongestWindow) {
      throw UsageError("--await: '" + text +
                       "', expected TOPIC:WINDOW with a window from 0 to 128 ticks");
    }
    awaited.window = static_cast<std::size_t>(window);
  }
  awaited.answered = std::make_shared<std::atomic<std::uint64_t>>(0);
  awaited.session = std::make_shared<std::atomic<std::uint64_t>>(0);
  node_.ReadRaw(*topic,
                [answered = awaited.answered, session = awaited.session](node::RawSample&& sample) {
                  node::HeadOfMessage head;
                  if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
                  answered->store(0);
                  session->store(head.session_id);
                  answered->store(head.tick + 1);
                });
  awaited_.push_back(std::move(awaited));
}

bool Answers::WaitBefore(const PlayedMessage& next) {
  if (awaited_.empty()) return true;
  if (!sent_ticks_.empty() && sent_session_ != next.session_id) sent_ticks_.clear();
  sent_session_ = next.session_id;
  for (const Awaited& awaited : awaited_) {
    if (sent_ticks_.size() <= awaited.window) continue;
    const std::uint64_t tick = sent_ticks_[sent_ticks_.size() - 1 - awaited.window];
    const auto give_up = Clock::now() + std::chrono::duration<double>(timeout_s_);
    while (awaited.session->load() != next.session_id || awaited.answered->load() < tick + 1) {
      if (stop_.requested()) return false;
      node_.WaitForData(milliseconds(50));
      if (Clock::now() > give_up) {
        throw std::runtime_error("no " + awaited.topic + " for tick " + std::to_string(tick) +
                                 " within " + std::to_string(static_cast<int>(timeout_s_)) +
                                 " s; is its writer running, in the same domain and in lockstep?");
      }
    }
  }
  sent_ticks_.push_back(next.tick);
  if (sent_ticks_.size() > kLongestWindow + 2) sent_ticks_.pop_front();
  return true;
}

}  // namespace sinew::logger

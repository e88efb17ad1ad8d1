// Messages of the rig's topics at a fixed rate, from a thread of this process: what a robot would
// send, without a robot.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "components/record/recording/cdr.h"
#include "components/topics/node/node.h"

namespace sinew::logger_bench {

// Those that a rig with its networks sends every cycle.
const std::vector<std::string>& RigTopics();
std::string RigTopicList();  // comma-separated

// A message of a topic of this build that is 0 but for its header.
class ZeroMessage {
 public:
  explicit ZeroMessage(const node::TopicInfo& topic);
  const recording::Bytes& At(std::uint64_t tick, std::int64_t stamp_ns);

 private:
  recording::IdlSchema idl_;
  const recording::IdlType& type_;
  recording::CdrField session_id_, tick_, stamp_ns_;
  recording::Bytes payload_;
};

class Traffic {
 public:
  Traffic(int domain_id, double rate_Hz);
  ~Traffic();
  Traffic(const Traffic&) = delete;
  Traffic& operator=(const Traffic&) = delete;

  // Readers that every topic has at least.
  int matched_readers() const;
  std::uint64_t ticks() const { return ticks_; }
  std::uint64_t failed() const { return failed_; }

 private:
  struct Line;
  void Run(double rate_Hz);

  node::Node node_;
  std::vector<std::unique_ptr<Line>> lines_;
  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> ticks_{0}, failed_{0};
  std::thread thread_;
};

}  // namespace sinew::logger_bench

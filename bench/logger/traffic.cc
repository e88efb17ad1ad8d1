#include "bench/logger/traffic.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "components/base/types/clock/clock.h"

namespace sinew::logger_bench {

namespace {

node::Options OptionsOf(int domain_id) {
  node::Options options;
  options.name = options.component = "traffic";
  options.domain_id = domain_id;
  return options;
}

}  // namespace

const std::vector<std::string>& RigTopics() {
  static const std::vector<std::string> kTopics = {
      "joint_state",     "actuator_state", "reference",        "regime",
      "valve_command",   "joint_command",  "pneumatic_state",  "torque_prediction",
      "reservoir_state", "readout",        "adaptation_state", "residual",
      "performance"};
  return kTopics;
}

std::string RigTopicList() {
  std::string list;
  for (const std::string& topic : RigTopics()) list += (list.empty() ? "" : ",") + topic;
  return list;
}

ZeroMessage::ZeroMessage(const node::TopicInfo& topic)
    : idl_(recording::IdlSchema::Parse(topic.idl)),
      type_(idl_.Struct(topic.type_name)),
      session_id_(type_, "header.session_id"),
      tick_(type_, "header.tick"),
      stamp_ns_(type_, "header.stamp_ns"),
      payload_(recording::ZeroCdr(type_)) {
  session_id_.SetInt(payload_, 1);
}

const recording::Bytes& ZeroMessage::At(std::uint64_t tick, std::int64_t stamp_ns) {
  tick_.SetInt(payload_, static_cast<std::int64_t>(tick));
  stamp_ns_.SetInt(payload_, stamp_ns);
  return payload_;
}

struct Traffic::Line {
  Line(const node::TopicInfo& topic, node::Node* node)
      : message(topic), writer(node->MakeRawWriter(topic)) {}
  ZeroMessage message;
  node::RawWriter writer;
};

Traffic::Traffic(int domain_id, double rate_Hz) : node_(OptionsOf(domain_id)) {
  for (const std::string& topic : RigTopics()) {
    lines_.push_back(std::make_unique<Line>(*node::FindTopic(topic), &node_));
  }
  thread_ = std::thread([this, rate_Hz] { Run(rate_Hz); });
}

Traffic::~Traffic() {
  stop_ = true;
  thread_.join();
}

int Traffic::matched_readers() const {
  int least = std::numeric_limits<int>::max();
  for (const auto& line : lines_) least = std::min(least, line->writer.matched_readers());
  return least;
}

void Traffic::Run(double rate_Hz) {
  const auto period = std::chrono::duration_cast<std::chrono::steady_clock::duration>(
      std::chrono::duration<double>(1.0 / rate_Hz));
  auto next = std::chrono::steady_clock::now();
  for (std::uint64_t tick = 0; !stop_; ++tick, next += period) {
    for (const auto& line : lines_) {
      const recording::Bytes& bytes = line->message.At(tick, types::EpochNow_ns());
      if (line->writer(bytes.data(), bytes.size()) != node::WriteStatus::kOk) ++failed_;
    }
    ++ticks_;
    std::this_thread::sleep_until(next);
  }
}

}  // namespace sinew::logger_bench

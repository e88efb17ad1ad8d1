#include "bridge/can/bus_model.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "bridge/can/bit_timing.h"

namespace sinew::can {
namespace {

constexpr int kErrorStep = 8;
constexpr int kPassiveLimit = 128;
constexpr int kBusOffLimit = 256;
// A collision shows somewhere in the data; half a frame is on the bus by then on average. One fixed
// length keeps the model simple: identifier, control and two bytes.
constexpr int kBitsBeforeCollision = 35;

}  // namespace

BusModel::BusModel(const BusConfig& config) : config_(config) {
  if (!(config.bitrate_bit_s >= 1e3 && config.bitrate_bit_s <= 1e6)) {
    throw std::invalid_argument("bitrate_bit_s = " + std::to_string(config.bitrate_bit_s) +
                                ", expected 1000 to 1000000");
  }
  if (config.queue_frames < 1) {
    throw std::invalid_argument("queue_frames = " + std::to_string(config.queue_frames) +
                                ", expected at least 1");
  }
}

int BusModel::Attach() {
  const auto free =
      std::find_if(nodes_.begin(), nodes_.end(), [](const Node& n) { return !n.attached; });
  // The place of a node that left is used again once nothing of it is on the bus.
  const int index = static_cast<int>(free - nodes_.begin());
  const bool on_bus =
      current_ && std::count(current_->senders.begin(), current_->senders.end(), index) > 0;
  if (free != nodes_.end() && !on_bus) {
    *free = Node{};
    free->attached = true;
    return index;
  }
  nodes_.emplace_back();
  nodes_.back().attached = true;
  return static_cast<int>(nodes_.size()) - 1;
}

void BusModel::Detach(int node) {
  if (node < 0 || node >= static_cast<int>(nodes_.size())) return;
  nodes_[static_cast<std::size_t>(node)] = Node{};
}

bool BusModel::Offer(int node, const Frame& frame, std::int64_t now_ns) {
  if (node < 0 || node >= static_cast<int>(nodes_.size()) || frame.error || frame.fd ||
      !IsValid(frame)) {
    ++counters_.refused;
    return false;
  }
  RestartNodes(now_ns);
  Node& sender = nodes_[static_cast<std::size_t>(node)];
  if (!sender.attached || sender.bus_off ||
      sender.queue.size() >= static_cast<std::size_t>(config_.queue_frames)) {
    ++counters_.refused;
    return false;
  }
  sender.queue.push_back({frame, now_ns});
  return true;
}

void BusModel::Advance(std::int64_t now_ns, const std::function<void(const Delivery&)>& deliver) {
  for (;;) {
    if (current_) {
      if (current_->end_ns > now_ns) break;
      const Transmission done = std::move(*current_);
      current_.reset();
      free_at_ns_ = done.end_ns;
      Finish(done, deliver);
      continue;
    }
    const auto start = NextStart();
    if (!start || *start > now_ns) break;
    current_ = Arbitrate(*start);
  }
  RestartNodes(now_ns);
}

std::optional<std::int64_t> BusModel::NextEnd() const {
  if (current_) return current_->end_ns;
  const auto start = NextStart();
  if (!start) return std::nullopt;
  return Arbitrate(*start).end_ns;
}

NodeHealth BusModel::health(int node) const {
  const Node& it = nodes_.at(static_cast<std::size_t>(node));
  if (it.bus_off) return NodeHealth::kBusOff;
  return it.transmit_errors >= kPassiveLimit ? NodeHealth::kPassive : NodeHealth::kActive;
}

int BusModel::queued(int node) const {
  return static_cast<int>(nodes_.at(static_cast<std::size_t>(node)).queue.size());
}

std::optional<std::int64_t> BusModel::NextStart() const {
  std::optional<std::int64_t> first;
  for (const Node& node : nodes_) {
    if (!node.queue.empty() && (!first || node.queue.front().offered_ns < *first)) {
      first = node.queue.front().offered_ns;
    }
  }
  if (first) first = std::max(*first, free_at_ns_);
  return first;
}

BusModel::Transmission BusModel::Arbitrate(std::int64_t start_ns) const {
  Transmission result;
  result.start_ns = start_ns;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].queue.empty() || nodes_[i].queue.front().offered_ns > start_ns) continue;
    const Frame& frame = nodes_[i].queue.front().frame;
    if (!result.senders.empty()) {
      const std::uint32_t key = ArbitrationKey(frame);
      const std::uint32_t best = ArbitrationKey(result.frame);
      if (key > best) continue;
      if (key == best) {
        result.senders.push_back(static_cast<int>(i));
        result.collision = result.collision || !(frame == result.frame);
        continue;
      }
    }
    result.senders.assign(1, static_cast<int>(i));
    result.frame = frame;
    result.collision = false;
  }
  const int bits =
      result.collision ? kBitsBeforeCollision + kErrorFrameBits : FrameBits(result.frame);
  result.end_ns = start_ns + BitsToNs(bits);
  return result;
}

void BusModel::Finish(const Transmission& done,
                      const std::function<void(const Delivery&)>& deliver) {
  counters_.busy_ns += done.end_ns - done.start_ns;
  if (done.collision) {
    ++counters_.error_frames;
    for (const int sender : done.senders) {
      Node& node = nodes_[static_cast<std::size_t>(sender)];
      if (!node.attached) continue;
      node.transmit_errors += kErrorStep;
      if (node.transmit_errors >= kBusOffLimit) {
        node.bus_off = true;
        node.queue.clear();
        node.restart_at_ns = done.end_ns + config_.restart_ns;
      }
    }
    return;
  }
  for (const int sender : done.senders) {
    Node& node = nodes_[static_cast<std::size_t>(sender)];
    if (!node.attached || node.queue.empty()) continue;
    node.queue.pop_front();
    node.transmit_errors = std::max(0, node.transmit_errors - 1);
  }
  ++counters_.frames;
  if (deliver) deliver({done.senders, done.frame, done.end_ns});
}

void BusModel::RestartNodes(std::int64_t now_ns) {
  if (config_.restart_ns < 0) return;
  for (Node& node : nodes_) {
    if (node.bus_off && now_ns >= node.restart_at_ns) {
      node.bus_off = false;
      node.transmit_errors = 0;
    }
  }
}

std::int64_t BusModel::BitsToNs(int bits) const {
  return static_cast<std::int64_t>(std::llround(1e9 * bits / config_.bitrate_bit_s));
}

}  // namespace sinew::can

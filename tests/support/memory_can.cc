#include "tests/support/memory_can.h"

#include <algorithm>

#include "bridge/can/bit_timing.h"

namespace sinew::can {

class MemoryBus::Node : public Transport {
 public:
  Node(MemoryBus& bus, std::string name, std::vector<IdFilter> filters)
      : bus_(bus),
        name_(std::move(name)),
        filters_(std::move(filters)),
        node_(bus.model_.Attach()) {}
  ~Node() override {
    bus_.model_.Detach(node_);
    std::erase(bus_.nodes_, this);
  }

  SendStatus Send(const Frame& frame) noexcept override {
    if (bus_.model_.Offer(node_, frame, bus_.now_ns_)) {
      ++counters_.sent;
      counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(frame));
      return SendStatus::kOk;
    }
    ++counters_.dropped;
    return link() == Link::kBusOff ? SendStatus::kDown : SendStatus::kDropped;
  }

  bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override {
    const std::int64_t give_up_ns = bus_.now_ns_ + std::max<std::int64_t>(timeout.count(), 0);
    while (inbox_.empty() && bus_.now_ns_ < give_up_ns) bus_.AdvanceOnce(give_up_ns);
    if (inbox_.empty()) return false;
    *received = inbox_.front();
    inbox_.pop_front();
    return true;
  }

  Link link() const noexcept override {
    switch (bus_.model_.health(node_)) {
      case NodeHealth::kBusOff:
        return Link::kBusOff;
      case NodeHealth::kPassive:
        return Link::kPassive;
      case NodeHealth::kActive:
        break;
    }
    return Link::kUp;
  }
  TransportCounters counters() const noexcept override {
    TransportCounters counters = counters_;
    counters.error_frames = bus_.model_.counters().error_frames;
    return counters;
  }
  std::int64_t now_ns() const noexcept override { return bus_.now_ns_; }
  const std::string& name() const noexcept override { return name_; }

  void Take(const Delivery& delivery) {
    if (std::count(delivery.senders.begin(), delivery.senders.end(), node_) > 0) return;
    if (link() == Link::kBusOff) return;  // neither sends nor receives
    counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(delivery.frame));
    if (!Passes(filters_, delivery.frame)) return;
    ++counters_.received;
    inbox_.push_back({delivery.frame, delivery.end_ns});
  }

 private:
  MemoryBus& bus_;
  std::string name_;
  std::vector<IdFilter> filters_;
  int node_;
  std::deque<Received> inbox_;
  TransportCounters counters_;
};

std::unique_ptr<Transport> MemoryBus::Join(std::string name, std::vector<IdFilter> filters) {
  auto node = std::make_unique<Node>(*this, std::move(name), std::move(filters));
  nodes_.push_back(node.get());
  return node;
}

void MemoryBus::AddAgent(std::function<std::int64_t()> next,
                         std::function<void(std::int64_t)> run) {
  agents_.push_back({std::move(next), std::move(run)});
}

void MemoryBus::AdvanceTo(std::int64_t time_ns) {
  while (now_ns_ < time_ns) AdvanceOnce(time_ns);
}

void MemoryBus::AdvanceOnce(std::int64_t time_ns) {
  std::int64_t next_ns = time_ns;
  if (const auto end = model_.NextEnd()) next_ns = std::min(next_ns, *end);
  for (const Agent& agent : agents_) next_ns = std::min(next_ns, agent.next());
  now_ns_ = std::max(now_ns_, next_ns);
  model_.Advance(now_ns_, [this](const Delivery& delivery) {
    if (on_frame_) on_frame_(delivery);
    for (Node* node : nodes_) node->Take(delivery);
  });
  for (const Agent& agent : agents_) {
    if (agent.next() <= now_ns_) agent.run(now_ns_);
  }
}

}  // namespace sinew::can

// One CAN bus as a model in time: arbitration by identifier, bit-true duration of every frame,
// transmit queues, collisions, bus-off. Classic frames only. Pure: time comes in; the server
// between processes (bridge/can/transport) and tests both drive it. One thread.
//
// Every node has a queue that it sends in order. When the bus is free, the heads offered by then
// arbitrate: the lowest ArbitrationKey wins and keeps the bus for FrameBits(frame) bit times; the
// others wait. Two nodes that send the same identifier at once with different content disturb each
// other: an error frame, transmit error counters plus 8 for both, another try, and above 255
// bus-off (the queue is thrown away, and offers are refused until `restart_ns` has passed).
// Identical frames sent at once are one frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

#include "bridge/can/frame.h"

namespace sinew::can {

struct BusConfig {
  double bitrate_bit_s = 1e6;
  int queue_frames = 64;                  // of each node
  std::int64_t restart_ns = 100'000'000;  // from bus-off to the next start; negative: never
};

struct BusCounters {
  std::uint64_t frames = 0;
  std::uint64_t error_frames = 0;
  std::uint64_t refused = 0;  // offers to a full queue or by a node that is bus-off
  std::int64_t busy_ns = 0;   // of all frames that ended
};

struct Delivery {
  std::vector<int> senders;  // usually one
  Frame frame;
  std::int64_t end_ns = 0;  // when the last bit was on the bus
};

enum class NodeHealth { kActive, kPassive, kBusOff };

class BusModel {
 public:
  explicit BusModel(const BusConfig& config);  // throws std::invalid_argument

  int Attach();
  void Detach(int node);

  // Puts a frame into the node's queue; false when it is full, the frame invalid, the node unknown
  // or bus-off. `now_ns` must not be before an earlier call's.
  bool Offer(int node, const Frame& frame, std::int64_t now_ns);

  // Lets time pass up to `now_ns`; every frame that ended by then is delivered, in order.
  void Advance(std::int64_t now_ns, const std::function<void(const Delivery&)>& deliver);

  // The time at which the next frame ends by itself (the one on the bus, or the one that will start
  // next); nothing when idle.
  std::optional<std::int64_t> NextEnd() const;

  NodeHealth health(int node) const;
  int queued(int node) const;
  const BusCounters& counters() const { return counters_; }
  const BusConfig& config() const { return config_; }

 private:
  struct Queued {
    Frame frame;
    std::int64_t offered_ns = 0;
  };
  struct Node {
    bool attached = false;
    std::deque<Queued> queue;
    int transmit_errors = 0;
    bool bus_off = false;
    std::int64_t restart_at_ns = 0;
  };
  struct Transmission {
    std::vector<int> senders;
    Frame frame;
    bool collision = false;
    std::int64_t start_ns = 0;
    std::int64_t end_ns = 0;
  };

  std::optional<std::int64_t> NextStart() const;
  Transmission Arbitrate(std::int64_t start_ns) const;
  void Finish(const Transmission& done, const std::function<void(const Delivery&)>& deliver);
  void RestartNodes(std::int64_t now_ns);
  std::int64_t BitsToNs(int bits) const;

  BusConfig config_;
  std::vector<Node> nodes_;
  std::optional<Transmission> current_;
  std::int64_t free_at_ns_ = 0;
  BusCounters counters_;
};

}  // namespace sinew::can

// A bus in one process on simulated time: BusModel behind the transport interface, so that bridge
// and virtual axes run without sockets or waiting. One thread.
//
// Time passes when a node waits in Receive, or by AdvanceTo. Agents (virtual axes) are run at their
// own times in between, so that one thread plays both ends.
#pragma once

#include <deque>
#include <functional>
#include <memory>

#include "bridge/can/bus_model.h"
#include "bridge/can/transport/transport.h"

namespace sinew::can {

class MemoryBus {
 public:
  explicit MemoryBus(const BusConfig& config) : model_(config) {}

  // The bus must outlive its nodes.
  std::unique_ptr<Transport> Join(std::string name, std::vector<IdFilter> filters = {});

  // `next` returns when the agent runs next, `run` is called then.
  void AddAgent(std::function<std::int64_t()> next, std::function<void(std::int64_t now_ns)> run);

  void AdvanceTo(std::int64_t time_ns);
  std::int64_t now_ns() const { return now_ns_; }
  const BusModel& model() const { return model_; }
  void OnFrame(std::function<void(const Delivery&)> callback) { on_frame_ = std::move(callback); }

 private:
  class Node;
  struct Agent {
    std::function<std::int64_t()> next;
    std::function<void(std::int64_t)> run;
  };
  // Goes to the next thing that happens, at most to `time_ns`.
  void AdvanceOnce(std::int64_t time_ns);

  BusModel model_;
  std::int64_t now_ns_ = 0;
  std::vector<Node*> nodes_;
  std::vector<Agent> agents_;
  std::function<void(const Delivery&)> on_frame_;
};

}  // namespace sinew::can

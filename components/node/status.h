// The state of a component: component_status on DDS, and the report to systemd.
//
// Thread: the one of the node's owner.
#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "components/node/node.h"
#include "components/node/systemd_link.h"
#include "components/node/writer_impl.h"

namespace sinew::node::internal {

class Status {
 public:
  Status(const std::string& component, const std::string& name)
      : component_(component), name_(name) {}

  // Publishes from here on, the first message at once.
  void Open(std::unique_ptr<WriterImpl> writer);
  // Publishes the last message (stopped, unless the component is in fault) and ends the writer.
  void Close();

  // Publishes at once when the state or the message changes. The first call means that the
  // component is configured: systemd is notified that it is ready.
  void SetState(Node::State state, const std::string& message);
  void SetCounts(const Node::Counts& counts);
  void SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns, int origin);
  // Publishes once a second; to be called from every wait.
  void PublishIfDue();

 private:
  void Publish();
  void ReportToSystemd();

  const std::string component_, name_;
  SystemdLink systemd_;
  std::unique_ptr<WriterImpl> writer_;
  std::chrono::steady_clock::time_point last_publication_{};
  bool reported_to_systemd_ = false;

  Node::State state_ = Node::State::kConfigured;
  std::string message_;
  Node::Counts counts_;
  std::uint64_t session_id_ = 0, tick_ = 0;
  std::int64_t stamp_ns_ = 0;
  int origin_ = 0;
};

}  // namespace sinew::node::internal

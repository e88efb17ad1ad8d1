// The state of a component: component_status on DDS, and the report to systemd; its log on DDS.
//
// Threads: the loop (the thread of the node's owner) sets values and counts its beats, which takes
// no system call and no wait; a thread of this class, of SCHED_OTHER, reads /proc and publishes. It
// publishes a change at once, and once a second if the loop has counted on since: the status of a
// loop that hangs grows old although its process lives. It sends the lines of the log (log.h) as
// they come. DDS threads count samples.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "components/topics/node/helper_thread.h"
#include "components/topics/node/node.h"
#include "components/topics/node/systemd_link.h"
#include "components/topics/node/writer_impl.h"

namespace sinew::node::internal {

class Status {
 public:
  Status(const std::string& component, const std::string& name);

  // Publishes from here on, the first message at once. log_writer: none: the log is not sent.
  void Open(std::unique_ptr<WriterImpl> writer, std::unique_ptr<WriterImpl> log_writer);
  // Publishes the last message (stopped, unless the component is in fault) and ends thread and
  // writer. A component in fault stays until 3 s after Open, so that every observer has found it.
  void Close();

  // Published at once when the state or the message changes; of changes in quick succession the
  // last one. The first call means that the component is configured: systemd is notified that it is
  // ready.
  void SetState(Node::State state, const std::string& message, const types::Fault& fault = {});
  // Published at once when they change, as the state.
  void SetStandby(bool standby);
  void SetPermittedReplay(const std::string& participant);
  void SetCounts(const Node::Counts& counts);
  void SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                msg::Origin origin);
  // The loop goes round; to be called from every wait.
  void Beat() noexcept;

  // Counts of all readers of the node.
  void CountMalformed() noexcept { malformed_.fetch_add(1, std::memory_order_relaxed); }
  void CountDropped() noexcept { dropped_.fetch_add(1, std::memory_order_relaxed); }

 private:
  struct Values {
    Node::State state = Node::State::kConfigured;
    std::string message, permitted_replay;
    types::Fault fault;
    bool standby = false;
    bool configured = false;  // SetState was called
    Node::Counts counts;
    std::uint64_t session_id = 0, tick = 0;
    std::int64_t stamp_ns = 0;
    msg::Origin origin{};
  };
  // Sets the value, and has the thread publish when it is another one.
  template <class Value>
  void Set(Value Values::*member, const Value& value);
  static msg::Header HeaderOf(const Values& values);
  void Run();
  void Publish(const Values& values);
  void SendLog(const Values& values);
  void ReportToSystemd(const Values& values);

  const std::string component_, name_, host_;
  SystemdLink systemd_;
  std::atomic<std::uint64_t> beats_{0}, malformed_{0}, dropped_{0};

  PriorityMutex mutex_;
  Values values_;
  bool changed_ = false, ended_ = false;

  WakeUp wake_up_;
  std::unique_ptr<WriterImpl> writer_, log_writer_;  // of the thread
  std::chrono::steady_clock::time_point opened_;
  std::uint64_t failed_publications_ = 0;
  std::thread thread_;
};

}  // namespace sinew::node::internal

#include "components/topics/node/status.h"

#include <sinew_idl/log.h>
#include <sinew_idl/status.h>
#include <unistd.h>

#include <fstream>
#include <mutex>
#include <utility>

#include "components/topics/node/filtered_transport.h"
#include "components/topics/node/host_name.h"
#include "components/topics/node/log.h"
#include "components/topics/node/ownership.h"
#include "components/topics/node/version.h"

namespace sinew::node::internal {

namespace {

double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

}  // namespace

Status::Status(const std::string& component, const std::string& name)
    : component_(component), name_(name), host_(HostName()) {}

void Status::Open(std::unique_ptr<WriterImpl> writer, std::unique_ptr<WriterImpl> log_writer) {
  writer_ = std::move(writer);
  log_writer_ = std::move(log_writer);
  if (log_writer_) WakeForLog(&wake_up_);
  opened_ = std::chrono::steady_clock::now();
  Beat();
  thread_ = std::thread([this] { Run(); });
}

void Status::Close() {
  // A reader that sees the writer go drops what it has not taken. Longest wait for one that is
  // stopped.
  constexpr std::chrono::milliseconds kHeard(200);
  systemd_.SetStopping();
  Beat();
  if (log_writer_) FlushLog(kHeard);  // what was logged so far is there to be sent
  {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    if (values_.state != Node::State::kFault) values_.state = Node::State::kStopped;
    ended_ = true;
  }
  wake_up_.Give();
  if (thread_.joinable()) thread_.join();
  if (log_writer_) WakeForLog(nullptr);
  // An observer must hear why it ends, also one that discovery has not matched with it yet: Fast
  // DDS repeats endpoints once a second (edp_heartbeat_period in EDPSimple.cpp), and a repeat may
  // be lost.
  constexpr auto kFound = kSettleTime + 2 * std::chrono::seconds(1);
  if (writer_ && values_.state == Node::State::kFault) {
    std::this_thread::sleep_until(opened_ + kFound);
  }
  if (writer_) (void)writer_->WaitAcknowledged(kHeard);
  if (log_writer_) (void)log_writer_->WaitAcknowledged(kHeard);
  writer_.reset();
  log_writer_.reset();
}

void Status::Beat() noexcept {
  beats_.fetch_add(1, std::memory_order_relaxed);
  systemd_.Beat();
}

void Status::SetState(Node::State state, const std::string& message, const types::Fault& fault) {
  Beat();
  {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    if (values_.configured && state == values_.state && message == values_.message &&
        fault == values_.fault) {
      return;
    }
    values_.configured = true;
    values_.state = state;
    values_.message = message;
    values_.fault = fault;
    changed_ = true;
  }
  wake_up_.Give();
}

template <class Value>
void Status::Set(Value Values::*member, const Value& value) {
  {
    const std::lock_guard<PriorityMutex> lock(mutex_);
    if (value == values_.*member) return;
    values_.*member = value;
    changed_ = true;
  }
  wake_up_.Give();
}

void Status::SetStandby(bool standby) { Set(&Values::standby, standby); }

void Status::SetPermittedReplay(const std::string& participant) {
  Set(&Values::permitted_replay, participant);
}

void Status::SetCounts(const Node::Counts& counts) {
  Beat();
  const std::lock_guard<PriorityMutex> lock(mutex_);
  values_.counts = counts;
}

void Status::SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                      msg::Origin origin) {
  Beat();
  const std::lock_guard<PriorityMutex> lock(mutex_);
  values_.session_id = session_id;
  values_.tick = tick;
  values_.stamp_ns = stamp_ns;
  values_.origin = origin;
}

void Status::Run() {
  using std::chrono::steady_clock;
  BecomeWriter("sinew-status");
  auto due = steady_clock::now();
  std::uint64_t published_beats = 0;
  while (true) {
    wake_up_.WaitUntil(due);
    Values values;
    bool changed = false, ended = false;
    {
      const std::lock_guard<PriorityMutex> lock(mutex_);
      values = values_;
      changed = std::exchange(changed_, false);
      ended = ended_;
    }
    if (changed) ReportToSystemd(values);
    if (log_writer_) SendLog(values);
    const std::uint64_t beats = beats_.load(std::memory_order_relaxed);
    const bool is_due = steady_clock::now() >= due;
    if (is_due || changed) due = steady_clock::now() + std::chrono::seconds(1);
    if (ended || changed || (is_due && beats != published_beats)) {
      published_beats = beats;
      Publish(values);
    }
    if (ended) return;
  }
}

msg::Header Status::HeaderOf(const Values& values) {
  return {values.session_id, values.tick, values.stamp_ns, values.origin};
}

void Status::Publish(const Values& values) {
  msg::ComponentStatus status;
  status.name = name_;
  status.component_kind = component_;
  status.header = HeaderOf(values);
  status.state = values.state;
  status.standby = values.standby;
  status.permitted_replay = values.permitted_replay;
  status.process_id = static_cast<std::uint32_t>(::getpid());
  status.host = host_;
  status.version = kVersion;
  status.idl_hash = AllTopicsHash();
  status.cycles = values.counts.cycles;
  status.stale_inputs = values.counts.stale_inputs;
  status.missed_ticks = values.counts.missed_ticks;
  status.write_failures = values.counts.write_failures + failed_publications_;
  status.malformed_samples = malformed_.load(std::memory_order_relaxed);
  status.dropped_samples = dropped_.load(std::memory_order_relaxed);
  const DatagramCounts datagrams = ReceivedDatagrams();
  status.received_datagrams = datagrams.received;
  status.refused_datagrams = datagrams.dropped;
  status.resident_MB = ResidentMegabytes();
  status.fault = types::ToMessage(values.fault);
  status.message = values.message.substr(0, 255);
  Bytes bytes;
  if (!Encode(status, &bytes) || writer_->WriteToDds(&bytes) != WriteStatus::kOk) {
    ++failed_publications_;
  }
}

void Status::SendLog(const Values& values) {
  Bytes bytes;
  while (std::optional<msg::LogLine> line = NextLogLine()) {
    line->header = HeaderOf(values);
    if (!Encode(*line, &bytes) || log_writer_->WriteToDds(&bytes) != WriteStatus::kOk) {
      ++failed_publications_;
    }
  }
}

void Status::ReportToSystemd(const Values& values) {
  systemd_.SetStatus(NameOf(values.state) + (values.message.empty() ? "" : ": " + values.message));
  if (values.state == Node::State::kStopped) systemd_.SetStopping();
}

}  // namespace sinew::node::internal

#include "components/node/status.h"

#include <sinew_idl/status.h>
#include <unistd.h>

#include <fstream>

#include "components/node/version.h"

namespace sinew::node::internal {

namespace {

double ResidentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  long total = 0, resident = 0;
  statm >> total >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

const char* Word(Node::State state) {
  switch (state) {
    case Node::State::kConfigured:
      return "configured";
    case Node::State::kActive:
      return "active";
    case Node::State::kFault:
      return "fault";
    case Node::State::kStopped:
      return "stopped";
  }
  return "fault";
}

msg::ComponentState ToMessage(Node::State state) {
  switch (state) {
    case Node::State::kConfigured:
      return msg::COMPONENT_CONFIGURED;
    case Node::State::kActive:
      return msg::COMPONENT_ACTIVE;
    case Node::State::kFault:
      return msg::COMPONENT_FAULT;
    case Node::State::kStopped:
      return msg::COMPONENT_STOPPED;
  }
  return msg::COMPONENT_FAULT;
}

}  // namespace

void Status::Open(std::unique_ptr<WriterImpl> writer) {
  writer_ = std::move(writer);
  systemd_.Beat();
  Publish();
}

void Status::Close() {
  systemd_.SetStopping();
  if (state_ != Node::State::kFault) state_ = Node::State::kStopped;
  systemd_.Beat();
  Publish();
  writer_.reset();
}

void Status::SetState(Node::State state, const std::string& message) {
  const bool changed = state != state_ || message != message_;
  state_ = state;
  message_ = message;
  systemd_.Beat();
  if (changed) {
    Publish();
  } else {
    PublishIfDue();
  }
  if (changed || !reported_to_systemd_) ReportToSystemd();
}

void Status::SetCounts(const Node::Counts& counts) {
  counts_ = counts;
  PublishIfDue();
}

void Status::SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                      int origin) {
  session_id_ = session_id;
  tick_ = tick;
  stamp_ns_ = stamp_ns;
  origin_ = origin;
  systemd_.Beat();
}

void Status::PublishIfDue() {
  systemd_.Beat();
  if (std::chrono::steady_clock::now() - last_publication_ >= std::chrono::seconds(1)) Publish();
}

void Status::Publish() {
  if (writer_ == nullptr) return;
  last_publication_ = std::chrono::steady_clock::now();
  char host[64] = {};
  ::gethostname(host, sizeof(host) - 1);
  msg::ComponentStatus status;
  status.name(name_);
  status.component_kind(component_);
  status.header().session_id(session_id_);
  status.header().tick(tick_);
  status.header().stamp_ns(stamp_ns_);
  status.header().origin(static_cast<msg::Origin>(origin_));
  status.state(ToMessage(state_));
  status.process_id(static_cast<std::uint32_t>(::getpid()));
  status.host(host);
  status.version(kVersion);
  status.idl_hash(AllTopicsHash());
  status.cycles(counts_.cycles);
  status.stale_inputs(counts_.stale_inputs);
  status.missed_ticks(counts_.missed_ticks);
  status.write_failures(counts_.write_failures);
  status.resident_MB(ResidentMegabytes());
  status.message(message_.substr(0, 255));
  Bytes bytes;
  if (!Encode(status, &bytes) || writer_->Write(&bytes) != WriteStatus::kOk) {
    ++counts_.write_failures;
  }
}

void Status::ReportToSystemd() {
  reported_to_systemd_ = true;
  systemd_.SetStatus(Word(state_) + (message_.empty() ? "" : ": " + message_));
  if (state_ == Node::State::kStopped) systemd_.SetStopping();
}

}  // namespace sinew::node::internal

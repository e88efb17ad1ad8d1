#include "components/topics/node/node.h"

#include <spdlog/spdlog.h>

#include <algorithm>

#include "components/topics/node/endpoint.h"
#include "components/topics/node/log.h"
#include "components/topics/node/node_impl.h"

namespace sinew::node {

namespace {

// The writer of the log, of the first node of a process that has one. None where the user's QoS
// profiles or certificate are of a version without it: the log is no reason to stop.
std::unique_ptr<internal::WriterImpl> LogWriter(const std::shared_ptr<internal::NodeImpl>& impl) {
  if (impl->apart() || !internal::LogIsUnsent()) return nullptr;
  try {
    return std::make_unique<internal::WriterImpl>(impl, *FindTopic(kLog.name));
  } catch (const DdsError& error) {
    spdlog::warn("the log is not sent: {}", error.what());
    return nullptr;
  }
}

}  // namespace

Node::Node(const Options& options, const std::vector<std::string>& joint_names)
    : impl_(std::make_shared<internal::NodeImpl>(options, joint_names)) {
  try {
    auto writer = std::make_unique<internal::WriterImpl>(impl_, *FindTopic(kComponentStatus.name));
    impl_->status.Open(std::move(writer), LogWriter(impl_));
  } catch (const internal::RefusedBySecurity& refused) {
    spdlog::info("{}; it runs without", refused.what());  // whoever may write nothing still reads
  }
}

Node::~Node() {
  impl_->ownership.Close();
  impl_->status.Close();
  impl_->raw_readers.clear();
}

void Node::ReadRaw(const TopicInfo& topic, RawCallback callback, bool wakes) {
  try {
    impl_->raw_readers.push_back(
        std::make_unique<internal::ReaderImpl>(impl_, topic, std::move(callback), wakes));
  } catch (const DdsError& error) {
    if (topic.name != kLog.name) throw;
    spdlog::warn("the log of others is not read: {}", error.what());
  }
}

int Node::RawMatchedWriters(const std::string& topic) const {
  int count = 0;
  for (const auto& reader : impl_->raw_readers) {
    if (reader->topic.name == topic) count += reader->matched();
  }
  return count;
}

std::uint64_t Node::RawLost(const std::string& topic) const {
  std::uint64_t count = 0;
  for (const auto& reader : impl_->raw_readers) {
    if (reader->topic.name == topic) count += reader->lost();
  }
  return count;
}

namespace {

eprosima::fastrtps::rtps::GUID_t GuidOf(const WriterId& writer) {
  eprosima::fastrtps::rtps::GUID_t guid;
  std::copy_n(writer.begin(), guid.guidPrefix.size, guid.guidPrefix.value);
  std::copy_n(writer.begin() + guid.guidPrefix.size, guid.entityId.size, guid.entityId.value);
  return guid;
}

}  // namespace

std::optional<Node::WriterName> Node::NameOf(const WriterId& writer) const {
  if (impl_->apart()) {
    const auto found = impl_->options.composition->NameOf(writer);
    if (!found) return std::nullopt;
    return WriterName{.participant = *found, .guid = "", .own = *found == impl_->options.name};
  }
  const auto guid = GuidOf(writer);
  WriterName name;
  name.guid = internal::TextOf(guid);
  name.own = Owns(writer);
  name.participant = name.own ? impl_->options.name : impl_->discovery.ParticipantOf(guid);
  if (name.participant.empty()) return std::nullopt;
  return name;
}

std::vector<std::string> Node::JointNamesOf(const WriterId& writer) const {
  return impl_->discovery.JointNamesOf(GuidOf(writer));
}

bool Node::Owns(const WriterId& writer) const {
  if (impl_->apart()) {
    const auto name = impl_->options.composition->NameOf(writer);
    return name && *name == impl_->options.name;
  }
  const auto& prefix = impl_->participant->guid().guidPrefix;
  return std::equal(prefix.value, prefix.value + prefix.size, writer.begin());
}

void Node::SetPeriod(std::chrono::nanoseconds period) {
  const std::lock_guard<std::mutex> lock(impl_->owned_readers_mutex);
  if (period == impl_->period) return;
  impl_->period = period;
  for (internal::ReaderImpl* reader : impl_->owned_readers) reader->SetPeriod(period);
}

std::vector<Endpoint> Node::Endpoints() const { return impl_->discovery.endpoints(); }

std::uint64_t Node::EndpointChanges() const { return impl_->discovery.changes(); }

std::vector<std::string> Node::Problems() const { return impl_->discovery.problems(); }

void Node::SetState(State state, const std::string& message, const types::Fault& fault) {
  impl_->status.SetState(state, message, fault);
}

void Node::SetStandby(bool standby) { impl_->status.SetStandby(standby); }
void Node::SetPermittedReplay(const std::string& participant) {
  impl_->status.SetPermittedReplay(participant);
}

void Node::SetCounts(const Counts& counts) { impl_->status.SetCounts(counts); }

void Node::SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                    msg::Origin origin) {
  impl_->status.SetCycle(session_id, tick, stamp_ns, origin);
}

bool Node::WaitForData(std::chrono::microseconds timeout) {
  const bool raised = impl_->signal.Wait(timeout);
  impl_->status.Beat();
  return raised;
}

void Node::Wake() { impl_->signal.Notify(nullptr); }

bool Node::has_security() const { return !impl_->apart() && impl_->participant->secure(); }

const Options& Node::options() const { return impl_->options; }

}  // namespace sinew::node

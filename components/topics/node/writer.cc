#include <algorithm>

#include "components/topics/node/all_messages.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/node_impl.h"
#include "components/topics/node/writer_impl.h"

namespace sinew::node {

namespace internal {

using eprosima::fastrtps::types::ReturnCode_t;

WriterImpl::WriterImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info)
    : node(std::move(owner)), topic(info) {
  if (node->apart()) {
    id_ = node->options.composition->NewId();
  } else {
    OpenDds();
  }
  if (node->options.composition != nullptr) node->options.composition->Add(this);
  if (HasOwners()) node->ownership.Add(this);
}

void WriterImpl::OpenDds() {
  dds::Topic* dds_topic = node->participant->FindOrMakeTopic(topic);
  dds::Publisher& publisher = node->participant->publisher();
  dds::DataWriterQos qos;
  const std::string profile = node->participant->ProfileFor(topic);
  if (publisher.get_datawriter_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("no writer QoS profile '" + profile + "'");
  }
  qos.ownership_strength().value = strength();
  writer_ = publisher.create_datawriter(dds_topic, qos, this,
                                        dds::StatusMask::offered_incompatible_qos());
  if (writer_ == nullptr) node->participant->Refuse("writer for topic '" + topic.name + "'");
  guid_ = TextOf(writer_->guid());
  std::copy_n(static_cast<const std::uint8_t*>(writer_->get_instance_handle().value), id_.size(),
              id_.begin());
}

WriterImpl::~WriterImpl() {
  if (node->options.composition != nullptr) node->options.composition->Remove(this);
  if (HasOwners()) node->ownership.Remove(this);
  if (writer_ == nullptr) return;
  if (node->options.mode == TimeMode::kLockstep && matched() > 0) {
    writer_->wait_for_acknowledgments({2, 0});
  }
  writer_->set_listener(nullptr);
  node->participant->publisher().delete_datawriter(writer_);
}

bool WriterImpl::HasOwners() const {
  return IsExclusive(topic.profile) && node->options.mode == TimeMode::kRealtime;
}

void WriterImpl::SetStrength(Strength strength) {
  if (strength == this->strength()) return;
  if (writer_ == nullptr) {
    strength_.store(strength, std::memory_order_relaxed);
    return;
  }
  dds::DataWriterQos qos = writer_->get_qos();
  qos.ownership_strength().value = strength;
  if (writer_->set_qos(qos) != ReturnCode_t::RETCODE_OK) {
    node->discovery.AddProblem("topic '" + topic.name + "': the ownership strength stays at " +
                               std::to_string(this->strength()));
    return;
  }
  strength_.store(strength, std::memory_order_relaxed);
}

WriteStatus WriterImpl::Write(Bytes* bytes) {
  if (bytes->empty()) return WriteStatus::kFailed;
  Composition* composition = node->options.composition;
  if (composition == nullptr || !composition->Carries(topic)) return WriteToDds(bytes);
  composition->Write(this, *bytes);
  return WriteStatus::kOk;
}

WriteStatus WriterImpl::WriteToDds(Bytes* bytes) {
  if (writer_ == nullptr) return WriteStatus::kOk;  // apart: nobody is there
  return writer_->write(static_cast<void*>(bytes)) ? WriteStatus::kOk : WriteStatus::kFailed;
}

int WriterImpl::matched() const {
  if (writer_ == nullptr) return 0;
  dds::PublicationMatchedStatus status;
  writer_->get_publication_matched_status(status);
  return status.current_count;
}

void WriterImpl::on_offered_incompatible_qos(dds::DataWriter*,
                                             const dds::OfferedIncompatibleQosStatus& status) {
  node->discovery.AddProblem(
      "topic '" + topic.name + "': a reader requests another " + PolicyName(status.last_policy_id) +
      " than this writer offers (does one side run in lockstep and the other not?)");
}

bool WriterImpl::WaitAcknowledged(std::chrono::milliseconds timeout) const {
  if (writer_ == nullptr) return true;
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(timeout);
  const auto remainder = std::chrono::duration_cast<std::chrono::nanoseconds>(timeout - seconds);
  const eprosima::fastrtps::Duration_t limit(static_cast<std::int32_t>(seconds.count()),
                                             static_cast<std::uint32_t>(remainder.count()));
  return writer_->wait_for_acknowledgments(limit) == ReturnCode_t::RETCODE_OK;
}

}  // namespace internal

template <class Message>
Writer<Message> Node::MakeWriter(const Topic<Message>& topic) {
  return Writer<Message>(std::make_shared<internal::WriterImpl>(impl_, *FindTopic(topic.name)));
}

template <class Message>
Writer<Message>::Writer(std::shared_ptr<internal::WriterImpl> impl) : impl_(std::move(impl)) {}
template <class Message>
Writer<Message>::Writer(Writer&&) noexcept = default;
template <class Message>
Writer<Message>& Writer<Message>::operator=(Writer&&) noexcept = default;
template <class Message>
Writer<Message>::~Writer() = default;

template <class Message>
WriteStatus Writer<Message>::Write(const Message& message) {
  if (!Encode(message, &impl_->scratch)) return WriteStatus::kFailed;
  return impl_->Write(&impl_->scratch);
}

template <class Message>
int Writer<Message>::matched_readers() const {
  return impl_->matched();
}

RawWriter Node::MakeRawWriter(const TopicInfo& topic) {
  return RawWriter(std::make_shared<internal::WriterImpl>(impl_, topic));
}

RawWriter::RawWriter(std::shared_ptr<internal::WriterImpl> impl) : impl_(std::move(impl)) {}

WriteStatus RawWriter::operator()(const std::byte* payload, std::size_t size) const {
  impl_->scratch.assign(payload, payload + size);
  return impl_->Write(&impl_->scratch);
}

int RawWriter::matched_readers() const { return impl_->matched(); }

std::uint32_t RawWriter::strength() const { return impl_->strength(); }

bool RawWriter::WaitAcknowledged(std::chrono::milliseconds timeout) const {
  return impl_->WaitAcknowledged(timeout);
}

#define SINEW_INSTANTIATE(Type)     \
  template class Writer<msg::Type>; \
  template Writer<msg::Type> Node::MakeWriter(const Topic<msg::Type>&);
SINEW_FOR_EACH_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node

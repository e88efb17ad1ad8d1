#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/all_messages.h"
#include "components/topics/node/composition.h"
#include "components/topics/node/node_impl.h"
#include "components/topics/node/reader_impl.h"

namespace sinew::node {

namespace internal {

using eprosima::fastrtps::types::ReturnCode_t;

ReaderImpl::ReaderImpl(std::shared_ptr<NodeImpl> owner, const TopicInfo& info,
                       Node::RawCallback on_sample, bool wakes)
    : node(std::move(owner)),
      topic(info),
      queue_limit(QueueLimit(info.profile, node->options.mode)),
      callback_(std::move(on_sample)),
      wakes_(wakes),
      queue_(queue_limit) {
  if (!node->apart()) OpenDds();
  if (node->options.composition != nullptr) node->options.composition->Add(this);
  if (!has_owners()) return;
  const std::lock_guard<std::mutex> lock(node->owned_readers_mutex);
  node->owned_readers.push_back(this);
  if (node->period.count() > 0) SetPeriod(node->period);
}

void ReaderImpl::OpenDds() {
  dds::Topic* dds_topic = node->participant->FindOrMakeTopic(topic);
  dds::Subscriber& subscriber = node->participant->subscriber();
  dds::DataReaderQos qos;
  const std::string profile = node->participant->ProfileFor(topic);
  if (subscriber.get_datareader_qos_from_profile(profile, qos) != ReturnCode_t::RETCODE_OK) {
    throw DdsError("no reader QoS profile '" + profile + "'");
  }
  if (callback_) {  // a recorder: the topic's own QoS with the history of a recorder
    dds::DataReaderQos log;
    if (subscriber.get_datareader_qos_from_profile("log", log) != ReturnCode_t::RETCODE_OK) {
      throw DdsError("no reader QoS profile 'log'");
    }
    qos.history(log.history());
  }
  reader_ = subscriber.create_datareader(dds_topic, qos, this,
                                         dds::StatusMask::data_available()
                                             << dds::StatusMask::sample_lost()
                                             << dds::StatusMask::requested_incompatible_qos());
  if (reader_ == nullptr) node->participant->Refuse("reader for topic '" + topic.name + "'");
}

ReaderImpl::~ReaderImpl() {
  if (node->options.composition != nullptr) node->options.composition->Remove(this);
  if (has_owners()) {
    const std::lock_guard<std::mutex> lock(node->owned_readers_mutex);
    std::erase(node->owned_readers, this);
  }
  if (reader_ != nullptr) {
    reader_->set_listener(nullptr);
    node->participant->subscriber().delete_datareader(reader_);
  }
  if (dropped() > 0 && dropping_is_a_loss()) {
    spdlog::warn("topic '{}': {} of {} samples were dropped unread", topic.name, dropped(),
                 received());
  }
}

bool ReaderImpl::has_owners() const {
  return IsExclusive(topic.profile) && node->options.mode == TimeMode::kRealtime;
}

void ReaderImpl::SetPeriod(std::chrono::nanoseconds period) {
  if (reader_ == nullptr) return;
  dds::DataReaderQos qos = reader_->get_qos();
  const auto deadline_ns = Deadline(period).count();
  if (qos.deadline().period.to_ns() == deadline_ns) return;
  qos.deadline().period = eprosima::fastrtps::Duration_t(1e-9 * static_cast<double>(deadline_ns));
  if (reader_->set_qos(qos) != ReturnCode_t::RETCODE_OK) {
    node->discovery.AddProblem("topic '" + topic.name + "': the deadline of its reader cannot be " +
                               std::to_string(deadline_ns / 1000000) + " ms");
  }
}

bool ReaderImpl::dropping_is_a_loss() const {
  return node->options.mode == TimeMode::kLockstep || topic.profile == Profile::kEvent ||
         topic.profile == Profile::kLatched;
}

void ReaderImpl::on_data_available(dds::DataReader* source) {
  dds::SampleInfo info;
  bool any = false;
  while (source->take_next_sample(&scratch_.bytes, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    scratch_.source_stamp_ns = info.source_timestamp.to_ns();
    scratch_.reception_stamp_ns = types::EpochNow_ns();
    std::copy_n(static_cast<const std::uint8_t*>(info.publication_handle.value),
                scratch_.writer.size(), scratch_.writer.begin());
    if (const Composition* composition = node->options.composition; composition != nullptr) {
      const bool composed = composition->Owns(scratch_.writer);
      composed_heard_.store(composed, std::memory_order_relaxed);
      if (composed && !callback_) continue;
    }
    received_.fetch_add(1, std::memory_order_relaxed);
    any = true;
    if (callback_) {
      callback_(
          RawSample{topic.name, std::move(scratch_.bytes), scratch_.source_stamp_ns,
                    scratch_.reception_stamp_ns, scratch_.writer,
                    static_cast<std::uint64_t>(info.sample_identity.sequence_number().to64long())});
      scratch_.bytes = Bytes();
      continue;
    }
    Queue(&scratch_);
  }
  if (any && wakes_) node->signal.Notify(this);
}

void ReaderImpl::Queue(Sample* sample) {
  if (queue_.Push(sample) || !dropping_is_a_loss()) return;
  node->status.CountDropped();
  if (queue_.dropped() == 1) {
    spdlog::warn("topic '{}': {} samples wait to be read, the oldest are dropped from here on",
                 topic.name, queue_limit);
  }
}

void ReaderImpl::TakeComposed(const Bytes& bytes, std::int64_t stamp_ns, const WriterId& writer) {
  if (callback_) {  // recorders hear DDS, where there is one
    if (!node->apart()) return;
    received_.fetch_add(1, std::memory_order_relaxed);
    callback_(RawSample{topic.name, bytes, stamp_ns, stamp_ns, writer});
    return;
  }
  if (has_owners() && !composed_heard_.load(std::memory_order_relaxed)) return;
  composed_.bytes = bytes;
  composed_.source_stamp_ns = composed_.reception_stamp_ns = stamp_ns;
  composed_.writer = writer;
  received_.fetch_add(1, std::memory_order_relaxed);
  Queue(&composed_);
}

void ReaderImpl::on_sample_lost(dds::DataReader*, const dds::SampleLostStatus& status) {
  lost_.store(static_cast<std::uint64_t>(status.total_count), std::memory_order_relaxed);
}

void ReaderImpl::on_requested_incompatible_qos(dds::DataReader*,
                                               const dds::RequestedIncompatibleQosStatus& status) {
  node->discovery.AddProblem(
      "topic '" + topic.name + "': a writer offers another " + PolicyName(status.last_policy_id) +
      " than this reader requests (does one side run in lockstep and the other not?)");
}

std::optional<Sample> ReaderImpl::TakeNext() { return queue_.TakeNext(); }

std::optional<Sample> ReaderImpl::TakeLatest() { return queue_.TakeLatest(); }

void ReaderImpl::WaitForSample(std::chrono::microseconds timeout) {
  const void* const sources[] = {this};
  if (queue_.empty()) node->signal.Wait(timeout, sources);
}

void ReaderImpl::CountMalformed() {
  const std::uint64_t count = malformed_.fetch_add(1, std::memory_order_relaxed) + 1;
  node->status.CountMalformed();
  // The 1st, 2nd, 4th, 8th: a writer that sends nothing else must not fill the log.
  if (!std::has_single_bit(count)) return;
  spdlog::warn("topic '{}': {} of {} samples were malformed and dropped", topic.name, count,
               received());
}

int ReaderImpl::matched() const {
  if (reader_ == nullptr) return 0;
  dds::SubscriptionMatchedStatus status;
  reader_->get_subscription_matched_status(status);
  return status.current_count;
}

}  // namespace internal

namespace {

// The next sample that means something; the malformed ones before it are counted and dropped.
template <class Message>
std::optional<Message> TakeDecoded(internal::ReaderImpl& reader,
                                   std::optional<internal::Sample> (internal::ReaderImpl::*take)(),
                                   WriterId* writer) {
  while (const auto sample = (reader.*take)()) {
    Message message;
    *writer = sample->writer;
    if (Decode(sample->bytes, &message)) return message;
    reader.CountMalformed();
  }
  return std::nullopt;
}

}  // namespace

template <class Message>
Reader<Message> Node::MakeReader(const Topic<Message>& topic) {
  return Reader<Message>(std::make_shared<internal::ReaderImpl>(impl_, *FindTopic(topic.name)));
}

template <class Message>
Reader<Message>::Reader(std::shared_ptr<internal::ReaderImpl> impl) : impl_(std::move(impl)) {}
template <class Message>
Reader<Message>::Reader(Reader&&) noexcept = default;
template <class Message>
Reader<Message>& Reader<Message>::operator=(Reader&&) noexcept = default;
template <class Message>
Reader<Message>::~Reader() = default;

template <class Message>
std::optional<Message> Reader<Message>::TakeNext() {
  return TakeDecoded<Message>(*impl_, &internal::ReaderImpl::TakeNext, &writer_);
}

template <class Message>
std::optional<Message> Reader<Message>::TakeLatest() {
  return TakeDecoded<Message>(*impl_, &internal::ReaderImpl::TakeLatest, &writer_);
}

template <class Message>
std::optional<Message> Reader<Message>::WaitNext(std::chrono::milliseconds timeout) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (true) {
    if (auto message = TakeNext()) return message;
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(
        deadline - std::chrono::steady_clock::now());
    if (left.count() <= 0) return std::nullopt;
    impl_->WaitForSample(left);
  }
}

template <class Message>
void Reader<Message>::WaitForSample(std::chrono::microseconds timeout) {
  impl_->WaitForSample(timeout);
  impl_->node->status.Beat();
}

template <class Message>
int Reader<Message>::matched_writers() const {
  return impl_->matched();
}
template <class Message>
std::uint64_t Reader<Message>::received() const {
  return impl_->received();
}
template <class Message>
std::uint64_t Reader<Message>::lost() const {
  return impl_->lost();
}
template <class Message>
std::uint64_t Reader<Message>::dropped() const {
  return impl_->dropped();
}
template <class Message>
std::uint64_t Reader<Message>::malformed() const {
  return impl_->malformed();
}

#define SINEW_INSTANTIATE(Type)     \
  template class Reader<msg::Type>; \
  template Reader<msg::Type> Node::MakeReader(const Topic<msg::Type>&);
SINEW_FOR_EACH_MESSAGE(SINEW_INSTANTIATE)
#undef SINEW_INSTANTIATE

}  // namespace sinew::node

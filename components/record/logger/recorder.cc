#include "components/record/logger/recorder.h"

#include <algorithm>

namespace sinew::logger {

using recording::Bytes;
using recording::IoStatus;

Recorder::Recorder(RecordingSink& sink, const std::vector<recording::TopicSchema>& topics,
                   std::vector<recording::McapMetadata> metadata, RecorderOptions options)
    : options_(std::move(options)),
      files_(sink, topics, std::move(metadata), options_.files),
      ring_(options_.ring.last, options_.ring.bytes,
            [this](const RecordedMessage& message) { files_.Pass(message); }),
      lost_(topics.size(), 0),
      dropped_(topics.size(), 0) {
  for (const recording::TopicSchema& topic : topics) {
    readers_.push_back(std::make_unique<TopicReader>(topic));
  }
  own_.topics.resize(topics.size());
  state_.topics.resize(topics.size());
  thread_ = std::thread([this] { Run(); });
}

Recorder::~Recorder() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    abandoned_ = !finishing_;
    finishing_ = true;
  }
  offered_.notify_all();
  taken_.notify_all();
  if (thread_.joinable()) thread_.join();
}

bool Recorder::Offer(std::size_t topic, Bytes payload, std::int64_t reception_ns,
                     const SampleOrigin& origin) {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto fits = [this, &payload] {
    return queue_.empty() || queued_bytes_ + payload.size() <= options_.queue_bytes;
  };
  if (options_.wait_for_capacity) {
    taken_.wait(lock, [&] { return fits() || finishing_ || !Takes(); });
  }
  if (finishing_ || !Takes()) return false;
  if (!fits()) {
    ++dropped_[topic];
    return false;
  }
  const std::size_t before = queued_bytes_;
  queued_bytes_ += payload.size();
  RecordedMessage& message = queue_.emplace_back();
  message.topic = topic;
  message.payload = std::move(payload);
  message.reception_ns = reception_ns;
  message.origin = origin;
  // A wake-up for each sample would cost more than the sample.
  const std::size_t early = options_.queue_bytes / 4;
  const bool wake =
      options_.wait_for_capacity ? queue_.size() == 1 : before < early && queued_bytes_ >= early;
  lock.unlock();
  if (wake) offered_.notify_one();
  return true;
}

void Recorder::SetLost(std::size_t topic, std::uint64_t lost) {
  const std::lock_guard<std::mutex> lock(mutex_);
  lost_[topic] = lost;
}

void Recorder::Trigger(const std::string& reason) {
  if (!has_ring()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    request_ = reason;
  }
  offered_.notify_one();
}

RecorderState Recorder::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  RecorderState state = state_;
  for (std::size_t i = 0; i < state.topics.size(); ++i) {
    TopicLosses& losses = state.topics[i].losses;
    losses.lost = lost_[i];
    losses.dropped = dropped_[i];
    state.losses.lost += losses.lost;
    state.losses.missing += losses.missing;
    state.losses.dropped += losses.dropped;
    state.losses.malformed += losses.malformed;
  }
  return state;
}

IoStatus Recorder::Finish() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (finishing_) return IoStatus::Failed("the recording is finished already");
    finishing_ = true;
  }
  offered_.notify_all();
  taken_.notify_all();
  thread_.join();
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_.status;
}

void Recorder::Note(const RecordedMessage& message, const MessageFacts& facts) {
  TopicState& topic = own_.topics[message.topic];
  ++topic.messages;
  ++own_.messages;
  if (message.origin.sequence > 0) {
    std::uint64_t& last = last_sequence_[{message.topic, message.origin.writer}];
    if (last > 0 && message.origin.sequence > last + 1) {
      topic.losses.missing += message.origin.sequence - last - 1;
    }
    last = std::max(last, message.origin.sequence);
  }
  if (facts.malformed) {
    ++topic.losses.malformed;
    return;
  }
  if (readers_[message.topic]->is_joint_state()) {
    if (topic.messages > 1 && topic.session_id == facts.session_id && facts.tick > topic.tick) {
      own_.missing_ticks += facts.tick - topic.tick - 1;
    }
    own_.session =
        SessionState{facts.session_id, facts.tick, facts.stamp_ns, facts.origin, facts.last_tick};
  }
  topic.session_id = facts.session_id;
  topic.tick = facts.tick;
}

bool Recorder::IsNewFault(const RecordedMessage& message, const MessageFacts& facts) {
  if (!options_.ring.on_fault || facts.malformed) return false;
  bool& in_fault = in_fault_[{message.topic, message.origin.writer}];
  const bool fresh = facts.fault && !in_fault;
  in_fault = facts.fault;
  return fresh;
}

IoStatus Recorder::WriteRing(const std::string& reason) {
  ++own_.triggers;
  own_.last_trigger = reason;
  ring_closes_ = std::chrono::steady_clock::now() + options_.ring.after;
  if (files_.open()) return IoStatus::Ok();  // it goes on for longer
  IoStatus status = files_.Begin({{"sinew.trigger", {{"reason", reason}}}});
  while (status.ok()) {
    const std::optional<RecordedMessage> message = ring_.Pop();
    if (!message) break;
    status = files_.Write(*message);
  }
  return status;
}

IoStatus Recorder::Take(RecordedMessage&& message) {
  const TopicReader& reader = *readers_[message.topic];
  const MessageFacts facts = reader.Read(&message.payload);
  message.stamp_ns = facts.malformed ? message.reception_ns : facts.stamp_ns;
  message.session_id = facts.session_id;
  message.instance = facts.instance;
  message.malformed = facts.malformed;
  Note(message, facts);
  if (!has_ring()) return files_.Write(message);
  const bool fault = IsNewFault(message, facts);
  const std::string reason = fault ? reader.FaultText(message.payload) : std::string();
  IoStatus status;
  if (files_.open()) {
    status = files_.Write(message);
  } else {
    ring_.Push(std::move(message));
  }
  if (fault && status.ok()) status = WriteRing(reason);
  return status;
}

IoStatus Recorder::TakeBatch(std::vector<RecordedMessage>* batch,
                             const std::optional<std::string>& request) {
  IoStatus status;
  for (RecordedMessage& message : *batch) {
    status = Take(std::move(message));
    if (!status.ok()) return status;
  }
  if (request) status = WriteRing(*request);
  const Instant now = std::chrono::steady_clock::now();
  if (status.ok()) status = files_.Tend(now);
  if (status.ok() && has_ring() && files_.open() && now >= ring_closes_) status = files_.End();
  return status;
}

void Recorder::ReadOn(std::vector<RecordedMessage>* batch) {
  for (RecordedMessage& message : *batch) {
    Note(message, readers_[message.topic]->Read(&message.payload));
  }
}

void Recorder::Publish(const IoStatus& status) {
  own_.status = status;
  own_.bytes = files_.bytes();
  own_.files = files_.files();
  own_.written = files_.messages();
  own_.ring_forgotten = ring_.forgotten();
  state_ = own_;
}

void Recorder::Run() {
  IoStatus status = has_ring() ? IoStatus::Ok() : files_.Begin();
  std::vector<RecordedMessage> batch;
  std::vector<TopicLosses> losses(readers_.size());
  std::unique_lock<std::mutex> lock(mutex_);
  while (status.ok() || options_.read_on_after_error) {
    offered_.wait_for(lock, options_.batch_span, [this] {
      return finishing_ || request_ || queued_bytes_ >= options_.queue_bytes / 4 ||
             (options_.wait_for_capacity && !queue_.empty());
    });
    if (abandoned_) break;
    const bool end = finishing_ && queue_.empty();
    batch.swap(queue_);
    queued_bytes_ = 0;
    const std::optional<std::string> request = std::exchange(request_, std::nullopt);
    for (std::size_t i = 0; i < losses.size(); ++i) {
      losses[i] = own_.topics[i].losses;
      losses[i].lost = lost_[i];
      losses[i].dropped = dropped_[i];
    }
    lock.unlock();
    taken_.notify_all();
    files_.SetLosses(losses);
    if (status.ok()) {
      status = TakeBatch(&batch, request);
    } else {
      ReadOn(&batch);
    }
    batch.clear();
    lock.lock();
    Publish(status);
    if (end) break;
  }
  const bool close = status.ok() && !abandoned_;
  lock.unlock();
  if (close) status = files_.End();
  lock.lock();
  Publish(status);
  queue_.clear();
  lock.unlock();
  taken_.notify_all();
}

}  // namespace sinew::logger

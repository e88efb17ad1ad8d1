#include "components/logger/recorder.h"

#include <algorithm>
#include <utility>

namespace sinew::logger {

using recording::Bytes;
using recording::CdrField;
using recording::IdlSchema;
using recording::IdlType;
using recording::IoStatus;

struct Recorder::Topic {
  explicit Topic(recording::TopicSchema topic_schema)
      : schema(std::move(topic_schema)),
        idl(IdlSchema::Parse(schema.idl)),
        type(idl.Struct(schema.type_name)),
        session_id(type, "header.session_id"),
        tick(type, "header.tick"),
        stamp_ns(type, "header.stamp_ns"),
        origin(type, "header.origin") {
    if (schema.topic == "joint_state") last_tick.emplace(type, "last_tick");
  }

  recording::TopicSchema schema;
  IdlSchema idl;
  const IdlType& type;
  CdrField session_id, tick, stamp_ns, origin;
  std::optional<CdrField> last_tick;  // joint_state only
  std::optional<recording::ChannelId> channel;
};

Recorder::Recorder(recording::ByteSink& sink, std::vector<recording::TopicSchema> topics,
                   std::vector<recording::McapMetadata> metadata, RecorderOptions options)
    : options_(options),
      writer_(sink, {"sinew", recording::Compression::kZstd,
                     std::chrono::nanoseconds(options.chunk_span).count(), 1u << 20}),
      metadata_(std::move(metadata)) {
  for (recording::TopicSchema& topic : topics) {
    topics_.push_back(std::make_unique<Topic>(std::move(topic)));
  }
  state_.topics.resize(topics_.size());
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

bool Recorder::Offer(std::size_t topic, Bytes payload, std::int64_t reception_ns) {
  std::unique_lock<std::mutex> lock(mutex_);
  const auto fits = [this, &payload] {
    return queue_.empty() || queued_bytes_ + payload.size() <= options_.queue_bytes;
  };
  if (options_.wait_for_capacity) {
    taken_.wait(lock, [&] { return fits() || finishing_ || !state_.status.ok(); });
  }
  if (finishing_ || !state_.status.ok()) return false;
  if (!fits()) {
    ++state_.topics[topic].dropped;
    ++state_.dropped;
    return false;
  }
  queued_bytes_ += payload.size();
  queue_.push_back({topic, std::move(payload), reception_ns});
  lock.unlock();
  offered_.notify_one();
  return true;
}

RecorderState Recorder::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_;
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

IoStatus Recorder::Write(Item* item) {
  Topic& topic = *topics_[item->topic];
  TopicState news;
  std::optional<SessionState> session;
  std::int64_t stamp_ns = item->reception_ns;
  bool malformed = false;
  try {
    recording::CanonicalizeCdr(topic.type, &item->payload);
    news.session_id = static_cast<std::uint64_t>(topic.session_id.AsInt(item->payload));
    news.tick = static_cast<std::uint64_t>(topic.tick.AsInt(item->payload));
    stamp_ns = topic.stamp_ns.AsInt(item->payload);
    if (topic.last_tick) {
      session =
          SessionState{news.session_id, news.tick, stamp_ns, topic.origin.AsInt(item->payload),
                       topic.last_tick->AsInt(item->payload) != 0};
    }
  } catch (const recording::CdrError&) {
    malformed = true;
  }
  if (!topic.channel) {
    recording::ChannelId channel{};
    if (IoStatus status = recording::AddTopic(topic.schema, &writer_, &channel); !status.ok())
      return status;
    topic.channel = channel;
  }
  IoStatus status =
      writer_.WriteMessage(*topic.channel, std::max<std::int64_t>(item->reception_ns, 0),
                           std::max<std::int64_t>(stamp_ns, 0), item->payload);
  if (!status.ok()) return status;

  const std::lock_guard<std::mutex> lock(mutex_);
  TopicState& state = state_.topics[item->topic];
  ++state.messages;
  ++state_.messages;
  state_.bytes = writer_.bytes_written();
  if (malformed) {
    ++state.malformed;
    ++state_.malformed;
    return status;
  }
  if (session && state.messages > 1 && state.session_id == news.session_id &&
      news.tick > state.tick) {
    state_.missing_ticks += news.tick - state.tick - 1;
  }
  state.session_id = news.session_id;
  state.tick = news.tick;
  if (session) state_.session = session;
  return status;
}

void Recorder::Run() {
  IoStatus status = writer_.Open();
  for (const recording::McapMetadata& metadata : metadata_) {
    if (status.ok()) status = writer_.WriteMetadata(metadata);
  }
  std::deque<Item> batch;
  std::unique_lock<std::mutex> lock(mutex_);
  while (status.ok()) {
    const bool news = offered_.wait_for(lock, options_.chunk_span,
                                        [this] { return !queue_.empty() || finishing_; });
    if (!news || queue_.empty()) {  // silence, or the end
      const bool end = finishing_;
      lock.unlock();
      status = writer_.CloseChunk();
      lock.lock();
      state_.bytes = writer_.bytes_written();
      if (end && queue_.empty()) break;
      continue;
    }
    if (abandoned_) break;
    batch.swap(queue_);
    queued_bytes_ = 0;
    lock.unlock();
    taken_.notify_all();
    for (Item& item : batch) {
      status = Write(&item);
      if (!status.ok()) break;
    }
    batch.clear();
    lock.lock();
  }
  const bool close = status.ok() && !abandoned_;
  lock.unlock();
  if (close) status = writer_.Close();
  lock.lock();
  state_.status = status;
  state_.bytes = writer_.bytes_written();
  queue_.clear();
  lock.unlock();
  taken_.notify_all();
}

}  // namespace sinew::logger

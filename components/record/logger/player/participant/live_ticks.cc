#include "components/record/logger/player/participant/live_ticks.h"

#include "components/record/recording/cdr.h"
#include "components/record/recording/idl_schema.h"
#include "components/topics/node/codec.h"

namespace sinew::logger {

LiveTicks::LiveTicks(node::Node& node) {
  const node::TopicInfo& info = *node::FindTopic(node::kJointState.name);
  const auto idl = std::make_shared<recording::IdlSchema>(recording::IdlSchema::Parse(info.idl));
  const recording::IdlType& type = idl->Struct(info.type_name);
  const recording::CdrField stamp(type, "header.stamp_ns");
  const recording::CdrField last(type, "last_tick");
  node.ReadRaw(info, [live = shared_, idl, stamp, last](node::RawSample&& sample) {
    node::HeadOfMessage head;
    if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
    try {
      const LiveTick tick{head.session_id, head.tick, stamp.AsInt(sample.payload),
                          last.AsInt(sample.payload) != 0};
      const std::lock_guard<std::mutex> lock(live->mutex);
      live->ticks.push_back(tick);
    } catch (const recording::CdrError&) {
    }
  });
}

std::optional<LiveTick> LiveTicks::TakeNext() {
  const std::lock_guard<std::mutex> lock(shared_->mutex);
  if (shared_->ticks.empty()) return std::nullopt;
  const LiveTick tick = shared_->ticks.front();
  shared_->ticks.pop_front();
  return tick;
}

}  // namespace sinew::logger

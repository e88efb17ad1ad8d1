#include "tools/rerun/stage.h"

#include <algorithm>
#include <stdexcept>

#include "components/record/recording/cdr.h"
#include "components/topics/node/topic_parties.h"
#include "components/topics/node/topics.h"

namespace sinew::rerun {
namespace {

node::Options OptionsOf(const std::string& name, node::TimeMode mode,
                        node::Composition* composition) {
  node::Options options;
  options.component = options.name = name;
  options.mode = mode;
  options.composition = composition;
  return options;
}

// Topics that a kind of participant writes, by the table of idl/README.md.
std::vector<std::string> TopicsWrittenBy(std::string_view kind) {
  std::vector<std::string> topics;
  for (const node::TopicParty& row : node::kTopicParties) {
    if (row.access == node::Access::kWrites && row.party == kind &&
        row.topic != node::kComponentSnapshot.name) {
      topics.emplace_back(row.topic);
    }
  }
  return topics;
}

}  // namespace

const recording::IdlType& TypeOf(std::string_view topic) {
  static std::map<std::string, recording::IdlSchema, std::less<>> schemas;
  const node::TopicInfo* info = node::FindTopic(topic);
  if (info == nullptr) throw std::invalid_argument("no topic '" + std::string(topic) + "'");
  auto found = schemas.find(topic);
  if (found == schemas.end()) {
    found = schemas.emplace(info->name, recording::IdlSchema::Parse(info->idl)).first;
  }
  return found->second.Struct(info->type_name);
}

Stage::Stage(const compose::Part& part, node::TimeMode mode, node::StopFlag& stop)
    : name_(part.name),
      kind_(part.program.substr(std::string("sinew-").size())),
      component_(compose::MakePart(part, OptionsOf(part.name, mode, &composition_), stop)),
      outputs_(TopicsWrittenBy(kind_)) {
  for (const node::TopicInfo& topic : node::AllTopics()) {
    // In real time a participant hears the owner of its own topics: here it is the owner.
    const bool own = std::find(outputs_.begin(), outputs_.end(), topic.name) != outputs_.end();
    if (!own && composition_.taken(topic.name).readers > 0) inputs_.push_back(topic.name);
  }
  outside_ = std::make_unique<node::Node>(OptionsOf("recording", mode, &composition_));
  for (const std::string& topic : inputs_) {
    feeds_.emplace(topic, outside_->MakeRawWriter(*node::FindTopic(topic)));
  }
  for (const std::string& topic : outputs_) {
    const recording::IdlType& type = TypeOf(topic);
    outside_->ReadRaw(*node::FindTopic(topic), [this, &type](node::RawSample&& sample) {
      recording::CanonicalizeCdr(type, &sample.payload);
      written_[sample.topic] = std::move(sample.payload);
    });
  }
}

bool Stage::Reads(std::string_view topic) const {
  return std::find(inputs_.begin(), inputs_.end(), topic) != inputs_.end();
}

void Stage::Feed(const std::string& topic, std::span<const std::byte> payload) {
  // A composition apart takes every write.
  (void)feeds_.at(topic)(payload.data(), payload.size());
}

bool Stage::Step() {
  written_.clear();
  return component_->Ready() && component_->Step();
}

const node::Bytes* Stage::Output(std::string_view topic) const {
  const auto found = written_.find(topic);
  return found == written_.end() ? nullptr : &found->second;
}

}  // namespace sinew::rerun

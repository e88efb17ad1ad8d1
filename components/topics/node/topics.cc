#include "components/topics/node/topics.h"

#include "components/topics/node/codec.h"
#include "components/topics/node/names.h"
#include "idl/embedded_idl.h"

namespace sinew::node {

std::string_view ProfileName(Profile profile) {
  switch (profile) {
    case Profile::kState:
      return "state";
    case Profile::kControl:
      return "control";
    case Profile::kEvent:
      return "event";
    case Profile::kLatched:
      return "latched";
    case Profile::kLog:
      return "log";
    case Profile::kLockstep:
      return "lockstep";
  }
  return "";
}

namespace {

template <class Message>
void Add(const Topic<Message>& topic, std::vector<TopicInfo>* topics) {
  TopicInfo info;
  info.name = topic.name;
  info.type_name = Message::kIdlName;
  info.profile = topic.profile;
  for (const idl::EmbeddedType& type : idl::EmbeddedTypes()) {
    if (type.type_name == info.type_name) {
      info.idl = type.text;
      info.idl_hash = type.hash;
    }
  }
  info.dds_type_name = internal::RegisteredTypeName(info.type_name, info.idl_hash);
  topics->push_back(std::move(info));
}

}  // namespace

const std::vector<TopicInfo>& AllTopics() {
  static const std::vector<TopicInfo> kTopics = [] {
    std::vector<TopicInfo> topics;
#define SINEW_ADD(topic) Add(topic, &topics);
    SINEW_FOR_EACH_TOPIC(SINEW_ADD)
#undef SINEW_ADD
    return topics;
  }();
  return kTopics;
}

const TopicInfo* FindTopic(std::string_view name) {
  for (const TopicInfo& topic : AllTopics()) {
    if (topic.name == name) return &topic;
  }
  return nullptr;
}

std::string AllTopicsHash() {
  std::uint32_t hash = 0x811C9DC5u;
  for (const TopicInfo& topic : AllTopics()) {
    for (const char letter : topic.name + topic.idl_hash) {
      hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x01000193u;
    }
  }
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (int shift = 28; shift >= 0; shift -= 4) text += kDigits[(hash >> shift) & 0xF];
  return text;
}

}  // namespace sinew::node

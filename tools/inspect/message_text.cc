#include "tools/inspect/message_text.h"

#include "components/base/types/joints.h"
#include "components/record/recording/file/cdr_json.h"

namespace sinew::inspect {

namespace {

using Json = nlohmann::ordered_json;
using recording::IdlType;

void CutJointArrays(const IdlType& type, Json& json) {
  if (type.kind == IdlType::Kind::kSequence || type.kind == IdlType::Kind::kArray) {
    for (Json& element : json) CutJointArrays(*type.element, element);
  }
  if (type.kind != IdlType::Kind::kStruct) return;
  std::size_t count = types::kMaxJoints;
  if (const auto found = json.find("joint_count"); found != json.end()) {
    count = found->get<std::size_t>();
  }
  for (const recording::IdlMember& member : type.members) {
    Json& value = json[member.name];
    const bool of_joints =
        member.type->kind == IdlType::Kind::kArray && member.type->bound == types::kMaxJoints;
    if (of_joints && count < value.size()) {
      value.erase(value.begin() + static_cast<std::ptrdiff_t>(count), value.end());
    }
    CutJointArrays(*member.type, value);
  }
}

}  // namespace

Json MessageJson(const IdlType& type, std::span<const std::byte> payload) {
  Json json = recording::CdrToJson(type, payload);
  CutJointArrays(type, json);
  return json;
}

TopicField SplitField(const std::string& text) {
  const std::size_t dot = text.find('.');
  return {text.substr(0, dot), dot == std::string::npos ? "" : text.substr(dot + 1)};
}

}  // namespace sinew::inspect

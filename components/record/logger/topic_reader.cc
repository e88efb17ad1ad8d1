#include "components/record/logger/topic_reader.h"

#include <sinew_idl/joint.h>
#include <sinew_idl/status.h>

#include <functional>

namespace sinew::logger {

namespace {

std::uint64_t InstanceOf(const std::vector<recording::CdrField>& keys,
                         const recording::Bytes& payload) {
  if (keys.empty()) return 0;
  std::string text;
  for (const recording::CdrField& key : keys) {
    text += key.type().is_number() ? std::to_string(key.AsInt(payload)) : key.AsText(payload);
    text += '\n';
  }
  return std::hash<std::string>()(text);
}

}  // namespace

TopicReader::TopicReader(const recording::TopicSchema& schema)
    : idl_(recording::IdlSchema::Parse(schema.idl)),
      type_(idl_.Struct(schema.type_name)),
      session_id_(type_, "header.session_id"),
      tick_(type_, "header.tick"),
      stamp_ns_(type_, "header.stamp_ns"),
      origin_(type_, "header.origin") {
  for (const std::string& key : recording::KeyFields(type_)) keys_.emplace_back(type_, key);
  if (schema.topic == "joint_state") {
    last_tick_.emplace(type_, "last_tick");
    robot_state_.emplace(type_, "robot_state");
  }
  if (schema.topic == "component_status") {
    component_state_.emplace(type_, "state");
    component_.emplace(type_, "name");
    reason_.emplace(type_, "message");
  }
}

MessageFacts TopicReader::Read(recording::Bytes* payload) const {
  MessageFacts facts;
  try {
    recording::CanonicalizeCdr(type_, payload);
    facts.session_id = static_cast<std::uint64_t>(session_id_.AsInt(*payload));
    facts.tick = static_cast<std::uint64_t>(tick_.AsInt(*payload));
    facts.stamp_ns = stamp_ns_.AsInt(*payload);
    facts.instance = InstanceOf(keys_, *payload);
    if (last_tick_) {
      facts.origin = origin_.AsInt(*payload);
      facts.last_tick = last_tick_->AsInt(*payload) != 0;
      const auto state = static_cast<msg::RobotState>(robot_state_->AsInt(*payload));
      facts.fault = state == msg::RobotState::kFault || state == msg::RobotState::kEstopped;
    }
    if (component_state_) {
      const auto state = static_cast<msg::ComponentState>(component_state_->AsInt(*payload));
      facts.fault = state == msg::ComponentState::kFault;
    }
  } catch (const recording::CdrError&) {
    facts = {};
    facts.malformed = true;
  }
  return facts;
}

std::string TopicReader::FaultText(const recording::Bytes& payload) const {
  if (robot_state_) return "joint_state: " + robot_state_->AsText(payload);
  if (!component_state_) return {};
  return "component_status: '" + component_->AsText(payload) +
         "' is in fault: " + reason_->AsText(payload);
}

}  // namespace sinew::logger

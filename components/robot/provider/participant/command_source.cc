#include "components/robot/provider/participant/command_source.h"

#include <spdlog/spdlog.h>

namespace sinew::provider {

CommandSource::CommandSource(node::Node& node)
    : node_(node), writer_(node.MakeWriter(node::kCommandSource)) {}

node::Node::WriterName CommandSource::NameOf(const std::optional<node::WriterId>& writer) const {
  if (!writer) return {};
  node::Node::WriterName name = node_.NameOf(*writer).value_or(node::Node::WriterName{});
  // GUIDs are random, and runs in lockstep repeat to the byte.
  if (node_.options().mode == node::TimeMode::kLockstep) name.guid.clear();
  return name;
}

void CommandSource::Publish(const types::MessageHeader& header) {
  if (!changed_) return;
  changed_ = false;
  const node::Node::WriterName joint = NameOf(joint_command_), valve = NameOf(valve_command_);
  spdlog::info("tick {}: joint_command of '{}', valve_command of '{}'", header.tick,
               joint.participant, valve.participant);
  msg::CommandSource message;
  message.header = header;
  message.joint_command_participant = joint.participant.substr(0, 64);
  message.joint_command_guid = joint.guid.substr(0, 64);
  message.valve_command_participant = valve.participant.substr(0, 64);
  message.valve_command_guid = valve.guid.substr(0, 64);
  if (writer_.Write(message) != node::WriteStatus::kOk) {
    changed_ = true;  // tried again in the next cycle
  }
}

}  // namespace sinew::provider

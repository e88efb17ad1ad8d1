// Publishes whose commands the state provider obeys: command_source, when that changes. Ownership
// of a topic is decided by each reader for itself; this is the provider's. Thread: the provider's
// loop.
#pragma once

#include <sinew_idl/operator.h>

#include <optional>

#include "components/base/types/message_header.h"
#include "components/topics/node/node.h"

namespace sinew::provider {

class CommandSource {
 public:
  // Throws DdsError.
  explicit CommandSource(node::Node& node);

  // Writers of the newest commands that count.
  void SetJointCommandWriter(const node::WriterId& writer) { Set(&joint_command_, writer); }
  void SetValveCommandWriter(const node::WriterId& writer) { Set(&valve_command_, writer); }
  // With the header of the running cycle. Writes and logs only when there is something new.
  void Publish(const types::MessageHeader& header);

 private:
  void Set(std::optional<node::WriterId>* writer, const node::WriterId& newest) {
    changed_ = changed_ || *writer != newest;
    *writer = newest;
  }
  node::Node::WriterName NameOf(const std::optional<node::WriterId>& writer) const;

  node::Node& node_;
  node::Writer<msg::CommandSource> writer_;
  std::optional<node::WriterId> joint_command_, valve_command_;
  bool changed_ = false;
};

}  // namespace sinew::provider

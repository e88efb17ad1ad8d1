// The permission to replay (replay_permission.h) in a loop: hears the operator, knows who writes,
// logs and publishes (component_status) what it decides.
//
// One thread, the loop's.
#pragma once

#include <string>

#include "components/topics/node/reader_impl.h"
#include "components/topics/node/replay_permission.h"

namespace sinew::node::internal {

class ReplayGate {
 public:
  // Makes a reader of operator_command on the node, which must outlive it. Throws DdsError.
  ReplayGate(Node& node, std::shared_ptr<NodeImpl> impl);

  // Once a cycle, before samples are assessed.
  void Cycle(const types::RunningSession& running, bool may_move);
  // A reference has come. True: it counts although it is replayed.
  bool Admits(const WriterId& writer);
  // For the log: whose replay was refused, and what permits it.
  std::string Refusal(const WriterId& writer) const;
  bool holds() const { return permission_.holds(); }

 private:
  // Logs and publishes what holds, where it is not what held before.
  void SayChange(const std::string& before);
  std::string NameOf(const WriterId& writer) const;

  Node& node_;
  ReaderImpl commands_;
  ReplayPermission permission_;
};

}  // namespace sinew::node::internal

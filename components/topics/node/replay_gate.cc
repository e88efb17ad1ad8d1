#include "components/topics/node/replay_gate.h"

#include <sinew_idl/operator.h>
#include <spdlog/spdlog.h>

#include <utility>

#include "components/topics/node/codec.h"
#include "components/topics/node/node_impl.h"

namespace sinew::node::internal {

ReplayGate::ReplayGate(Node& node, std::shared_ptr<NodeImpl> impl)
    : node_(node), commands_(std::move(impl), *FindTopic(kOperatorCommand.name)) {}

void ReplayGate::Cycle(const types::RunningSession& running, bool may_move) {
  const std::string before = permission_.participant();
  permission_.Cycle(running, may_move);
  while (const auto sample = commands_.TakeNext()) {
    msg::OperatorCommand command;
    if (!Decode(sample->bytes, &command)) {
      commands_.CountMalformed();
      continue;
    }
    if (types::KindOf(command.action) == types::CommandKind::kStop) {
      permission_.End("the operator's stop");
    }
    if (command.action != types::OperatorAction::kPermitReplay) continue;
    const std::string name = command.target;
    const std::string why = permission_.Give(command.header, name);
    if (!why.empty()) spdlog::warn("permit-replay of '{}' refused: {}", name, why);
  }
  SayChange(before);
}

bool ReplayGate::Admits(const WriterId& writer) {
  if (!permission_.holds()) return false;
  if (permission_.Allows(writer)) return true;
  const std::string before = permission_.participant();
  permission_.Heard(writer, NameOf(writer));
  SayChange(before);
  return permission_.Allows(writer);
}

std::string ReplayGate::Refusal(const WriterId& writer) const {
  const std::string name = NameOf(writer);
  return "'" + name + "' plays a recording; 'sinew permit-replay " + name +
         "' lets it move this robot";
}

void ReplayGate::SayChange(const std::string& before) {
  const std::string& now = permission_.participant();
  if (now == before) return;
  node_.SetPermittedReplay(now);
  if (now.empty()) {
    spdlog::warn("permit-replay of '{}' has ended: {}", before, permission_.ended());
  } else {
    spdlog::warn(
        "permit-replay: the recording that '{}' plays may move this robot until it is disarmed",
        now);
  }
}

std::string ReplayGate::NameOf(const WriterId& writer) const {
  const auto name = node_.NameOf(writer);
  return name ? name->participant : "";
}

}  // namespace sinew::node::internal

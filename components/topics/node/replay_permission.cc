#include "components/topics/node/replay_permission.h"

namespace sinew::node {

void ReplayPermission::Cycle(const types::RunningSession& running, bool may_move) {
  if (running.session_id != running_.session_id) End("a new session");
  if (!may_move) End("the robot is not armed any more");
  running_ = running;
  may_move_ = may_move;
}

std::string ReplayPermission::Give(const types::MessageHeader& header,
                                   std::string_view participant) {
  const auto refusal = types::RefusalOf(types::CommandKind::kPermission, header, running_);
  if (refusal != types::CommandRefusal::kNone) return types::RefusalText(refusal);
  if (participant.empty()) return "it names nobody";
  if (!may_move_) return "the robot is not armed";
  if (participant == participant_) return {};
  participant_ = participant;
  writer_.reset();
  return {};
}

void ReplayPermission::End(std::string_view why) {
  if (!holds()) return;
  ended_ = why;
  participant_.clear();
  writer_.reset();
}

void ReplayPermission::Heard(const WriterId& writer, std::string_view participant) {
  if (!holds() || Allows(writer)) return;
  if (writer_ || participant != participant_) {
    End("'" + std::string(participant) + "' is heard");
    return;
  }
  writer_ = writer;
}

}  // namespace sinew::node

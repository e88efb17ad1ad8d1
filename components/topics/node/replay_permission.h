// An operator's permission for a recording to move live hardware: for the replayed reference of one
// participant, in one session.
//
//     given by   PERMIT_REPLAY of a live operator in the running session (command_rule.h),
//                while the robot is armed; it names the participant that writes the recording
//     holds for  the first writer of that name that is heard afterwards, and for no other one
//     ends with  disarm, estop, a fault or a new session; when anybody else's reference is heard
//
// While it holds, a replayed reference of that writer counts as if it were live, and what is
// computed from it is live. Without it, live hardware refuses every replayed reference.
//
// Pure; one thread.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "components/base/types/command_rule.h"
#include "components/topics/node/writer_id.h"

namespace sinew::node {

class ReplayPermission {
 public:
  // Once a cycle, before the others: the session of the state provider, and whether the robot may
  // move.
  void Cycle(const types::RunningSession& running, bool may_move);
  // The operator's command. Empty: given. Else why not.
  std::string Give(const types::MessageHeader& header, std::string_view participant);
  void End(std::string_view why);
  // A reference of this writer has come, whatever its origin.
  void Heard(const WriterId& writer, std::string_view participant);

  // A replayed reference of this writer counts.
  bool Allows(const WriterId& writer) const { return writer_ && *writer_ == writer; }
  bool holds() const { return !participant_.empty(); }
  const std::string& participant() const { return participant_; }
  const std::string& ended() const { return ended_; }  // why the last one ended

 private:
  types::RunningSession running_;
  bool may_move_ = false;
  std::string participant_;         // empty: no permission
  std::optional<WriterId> writer_;  // once it was heard
  std::string ended_;
};

}  // namespace sinew::node

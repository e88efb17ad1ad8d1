// The one rule of which commands count, for every message that can move the robot or permit it to
// be moved (the commanding topics of idl/README.md). Pure.
//
// The running session is the one that the state provider announces in joint_state. A row is what a
// message may be, columns are the origin of the session:
//
//     kind          session           live       simulated         replayed
//     kStop         any               any        any               any
//     kRequest      the running one   LIVE       any               any
//     kPermission   the running one   LIVE       LIVE or SIM       LIVE or SIM
//
// A replayed request thus acts in a simulation only, and there because a player was made to send
// it: players send commanding topics only when they are named. A recording never permits anything.
#pragma once

#include <array>
#include <cstdint>

#include "components/base/types/message_header.h"
#include "components/base/types/operator_action.h"
#include "components/base/types/robot_state.h"

namespace sinew::types {

enum class CommandKind {
  kStop,        // less motion: disarm, estop
  kRequest,     // motion: commands, references, requests, disturbances, start and stop
  kPermission,  // who may move the robot: arm, reset, handover, permit replay
};
inline constexpr int kCommandKinds = 3;

enum class CommandRefusal { kNone, kOtherSession, kOrigin };

struct RunningSession {
  std::uint64_t session_id = 0;
  Origin origin = Origin::kSim;  // of the state provider's messages
};

constexpr CommandKind KindOf(OperatorAction action) noexcept {
  switch (action) {
    case OperatorAction::kDisarm:
    case OperatorAction::kEstop:
      return CommandKind::kStop;
    case OperatorAction::kStart:
    case OperatorAction::kStop:
      return CommandKind::kRequest;
    case OperatorAction::kArm:
    case OperatorAction::kReset:
    case OperatorAction::kHandover:
    case OperatorAction::kPermitReplay:
      break;
  }
  return CommandKind::kPermission;
}

constexpr CommandRefusal RefusalOf(CommandKind kind, const MessageHeader& header,
                                   const RunningSession& running) noexcept {
  // By the message's origin: LIVE, SIM, REPLAY.
  struct Row {
    bool any_session;
    std::array<bool, CountOf(Origin{})> on_live, elsewhere;
  };
  constexpr std::array<Row, kCommandKinds> kTable = {{
      {true, {true, true, true}, {true, true, true}},
      {false, {true, false, false}, {true, true, true}},
      {false, {true, false, false}, {true, true, false}},
  }};
  const Row& row = kTable[static_cast<std::size_t>(kind)];
  if (!row.any_session && header.session_id != running.session_id) {
    return CommandRefusal::kOtherSession;
  }
  const auto& allowed = running.origin == Origin::kLive ? row.on_live : row.elsewhere;
  return allowed[static_cast<std::size_t>(header.origin)] ? CommandRefusal::kNone
                                                          : CommandRefusal::kOrigin;
}

constexpr const char* RefusalText(CommandRefusal refusal) noexcept {
  switch (refusal) {
    case CommandRefusal::kNone:
      break;
    case CommandRefusal::kOtherSession:
      return "it is of another session";
    case CommandRefusal::kOrigin:
      return "it comes from a recording or a simulation";
  }
  return "";
}

}  // namespace sinew::types

// Carries the page's commands to the robot, on the way of `sinew estop`, `arm` and so on: the
// socket of a state provider of this host (estop), and operator_command, repeated until the robot
// says that it is done. One thread, but for Ask.
#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "components/base/types/fault.h"
#include "components/topics/node/node.h"
#include "tools/view/pending_action.h"

namespace sinew::live {

class OperatorDesk {
 public:
  // sockets: of state providers on this host; empty: those of the domain. With a certificate that
  // may not command it goes on, and its estop is by sockets alone.
  OperatorDesk(node::Node& node, std::vector<std::filesystem::path> sockets);

  // Any thread. action: as PendingAction::Ask. Empty, or why not.
  std::string Ask(OperatorAction action);
  // Hears the robot and sends what is due; waits at most 500 ms, for a socket's answer.
  void Step(std::int64_t now_ns);

  // State of the last action: {"action", "pending", "done", "why"}; null: none was asked for.
  nlohmann::ordered_json Report() const;
  std::optional<RobotState> robot(std::int64_t now_ns) const;
  // Cause, value, limit and remedy of the newest joint_state; empty: no fault.
  std::string fault() const { return types::FaultText(fault_); }

 private:
  void PressSockets(std::int64_t now_ns);
  void Send(OperatorAction action);

  node::Node& node_;
  const std::vector<std::filesystem::path> sockets_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::ComponentStatus> statuses_;
  std::optional<node::Writer<msg::OperatorCommand>> commands_;  // none: DDS security refuses it
  std::string why_not_;                                         // then
  std::mutex mutex_;
  std::optional<OperatorAction> asked_;  // guarded: since the last Step
  bool estop_pending_ = false;           // guarded
  PendingAction action_;
  std::optional<RobotState> robot_;
  types::Fault fault_;
  std::uint64_t session_id_ = 0, tick_ = 0;
  std::int64_t stamp_ns_ = 0;
  msg::Origin origin_{};
  std::int64_t heard_ns_ = 0;
  bool idled_ = false;  // by a socket, since the estop was asked for
};

}  // namespace sinew::live

// The operator's request on the page, until the robot has done it: when it is sent, sent again,
// done or given up.
//
// An estop is repeated until the robot says that it has stopped, takes the place of whatever was
// asked before, and nothing takes its place. The others are given up after kLimit_ns; arm and reset
// are for the session that is heard, so they are not sent before one is. Pure; not synchronized.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "components/base/types/operator_action.h"
#include "components/base/types/robot_state.h"

namespace sinew::live {

using types::OperatorAction;
using types::RobotState;

class PendingAction {
 public:
  static constexpr std::int64_t kRepeat_ns = 100'000'000;
  static constexpr std::int64_t kLimit_ns = 5'000'000'000;

  // action: disarm, arm, estop or reset. False: an estop is not confirmed yet.
  bool Ask(OperatorAction action, std::int64_t now_ns);
  // robot: what it says now; nothing: not heard. An action: send it now.
  std::optional<OperatorAction> Due(std::optional<RobotState> robot, std::int64_t now_ns);
  // Reached, or refused for good, as somebody else than the robot's state says.
  void End(bool done, const std::string& why);

  bool pending() const { return pending_; }
  // Report of the last action that was asked for; nothing: none yet.
  struct Report {
    OperatorAction action{};
    bool done = false;
    std::string why;  // neither done nor pending: why not
  };
  const std::optional<Report>& report() const { return report_; }

 private:
  std::optional<Report> report_;
  bool pending_ = false;
  bool sent_ = false;
  std::int64_t asked_ns_ = 0, sent_ns_ = 0;
};

}  // namespace sinew::live

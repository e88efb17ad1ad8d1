#include "tools/view/pending_action.h"

namespace sinew::live {

bool PendingAction::Ask(OperatorAction action, std::int64_t now_ns) {
  if (pending_ && report_->action == OperatorAction::kEstop && action != OperatorAction::kEstop)
    return false;
  report_ = Report{action, false, {}};
  pending_ = true;
  sent_ = false;
  asked_ns_ = now_ns;
  return true;
}

std::optional<OperatorAction> PendingAction::Due(std::optional<RobotState> robot,
                                                 std::int64_t now_ns) {
  if (!pending_) return std::nullopt;
  const OperatorAction action = report_->action;
  // The robot's state from before the first sending is no answer to it.
  if (sent_ && robot && types::HasReached(*robot, action)) {
    End(true, "");
    return std::nullopt;
  }
  if (action != OperatorAction::kEstop && now_ns - asked_ns_ >= kLimit_ns) {
    End(false, robot ? std::string("the robot stays in '") + NameOf(*robot) + "'"
                     : "no state provider heard");
    return std::nullopt;
  }
  if ((types::IsBoundToSession(action) && !robot) || (sent_ && now_ns - sent_ns_ < kRepeat_ns)) {
    return std::nullopt;
  }
  sent_ = true;
  sent_ns_ = now_ns;
  return action;
}

void PendingAction::End(bool done, const std::string& why) {
  if (!pending_) return;
  pending_ = false;
  report_->done = done;
  report_->why = why;
}

}  // namespace sinew::live

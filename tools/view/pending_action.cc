#include "tools/view/pending_action.h"

#include <algorithm>
#include <array>
#include <vector>

namespace sinew::live {

namespace {

struct ActionRule {
  OperatorAction action;
  std::vector<RobotState>
      reached;  // states that mean it was done, as `sinew arm` and so on have them
  bool needs_session;
  bool given_up;  // after kLimit_ns
};

const ActionRule& RuleOf(OperatorAction action) {
  static const std::array<ActionRule, 4> kRules = {{
      {OperatorAction::kDisarm,
       {RobotState::kDisarmed, RobotState::kFault, RobotState::kEstopped},
       false,
       true},
      {OperatorAction::kArm, {RobotState::kArmed, RobotState::kDamped}, true, true},
      {OperatorAction::kEstop, {RobotState::kEstopped}, false, false},
      {OperatorAction::kReset, {RobotState::kDisarmed}, true, true},
  }};
  return *std::find_if(kRules.begin(), kRules.end(),
                       [action](const ActionRule& rule) { return rule.action == action; });
}

}  // namespace

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
  const ActionRule& rule = RuleOf(report_->action);
  // The robot's state from before the first sending is no answer to it.
  if (sent_ && robot &&
      std::find(rule.reached.begin(), rule.reached.end(), *robot) != rule.reached.end()) {
    End(true, "");
    return std::nullopt;
  }
  if (rule.given_up && now_ns - asked_ns_ >= kLimit_ns) {
    End(false, robot ? std::string("the robot stays in '") + NameOf(*robot) + "'"
                     : "no state provider heard");
    return std::nullopt;
  }
  if ((rule.needs_session && !robot) || (sent_ && now_ns - sent_ns_ < kRepeat_ns)) {
    return std::nullopt;
  }
  sent_ = true;
  sent_ns_ = now_ns;
  return rule.action;
}

void PendingAction::End(bool done, const std::string& why) {
  if (!pending_) return;
  pending_ = false;
  report_->done = done;
  report_->why = why;
}

}  // namespace sinew::live

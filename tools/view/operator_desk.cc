#include "tools/view/operator_desk.h"

#include <sinew_idl/joint.h>
#include <sinew_idl/status.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "components/robot/estop/press.h"
#include "components/robot/estop/socket_folder.h"

namespace sinew::live {

namespace {

constexpr std::int64_t kStateAge_ns = 1'000'000'000;  // older: the robot is not heard
constexpr const char* kReason = "page of sinew-view";

}  // namespace

OperatorDesk::OperatorDesk(node::Node& node, std::vector<std::filesystem::path> sockets)
    : node_(node),
      sockets_(std::move(sockets)),
      states_(node.MakeReader(node::kJointState)),
      statuses_(node.MakeReader(node::kComponentStatus)) {
  try {
    commands_.emplace(node.MakeWriter(node::kOperatorCommand));
  } catch (const node::DdsError& refused) {
    why_not_ = refused.what();
    spdlog::warn("the page shows and commands nothing: {}", why_not_);
  }
}

std::string OperatorDesk::Ask(OperatorAction action) {
  if (!commands_ && action != OperatorAction::kEstop) return why_not_;
  {
    const std::lock_guard lock(mutex_);
    const bool estop_waits = estop_pending_ || asked_ == OperatorAction::kEstop;
    if (estop_waits && action != OperatorAction::kEstop) return "an estop is not confirmed yet";
    asked_ = action;
  }
  node_.Wake();
  return {};
}

void OperatorDesk::Step(std::int64_t now_ns) {
  bool stopped = false;
  while (const auto state = states_.TakeNext()) {  // ESTOPPED may last no longer than a cycle
    robot_ = state->robot_state;
    fault_ = types::FromMessage(state->fault);
    stopped = stopped || *robot_ == RobotState::kEstopped;
    session_id_ = state->header.session_id;
    tick_ = state->header.tick;
    stamp_ns_ = state->header.stamp_ns;
    origin_ = state->header.origin;
    heard_ns_ = now_ns;
  }
  std::string refusal;
  while (const auto status = statuses_.TakeNext()) {
    const std::string message = status->message;
    if (message.starts_with("arm refused")) refusal = status->name + ": " + message;
  }

  std::optional<OperatorAction> asked;
  {
    const std::lock_guard lock(mutex_);
    asked = std::exchange(asked_, std::nullopt);
  }
  if (asked && action_.Ask(*asked, now_ns)) {
    spdlog::warn("{} asked for on the page", NameOf(*asked));
    idled_ = false;
    refusal.clear();  // an earlier one's
  }
  const std::optional<RobotState> now =
      stopped ? std::optional(RobotState::kEstopped) : robot(now_ns);
  if (!refusal.empty() && action_.pending() && action_.report()->action == OperatorAction::kArm) {
    action_.End(false, refusal);
  }
  if (const auto due = action_.Due(now, now_ns)) {
    Send(*due);
    if (*due == OperatorAction::kEstop) PressSockets(now_ns);
  }
  const std::lock_guard lock(mutex_);
  estop_pending_ = action_.pending() && action_.report()->action == OperatorAction::kEstop;
}

void OperatorDesk::Send(OperatorAction action) {
  if (!commands_) return;
  msg::OperatorCommand command;
  command.header.session_id = session_id_;
  command.header.tick = tick_;
  command.header.stamp_ns = stamp_ns_;
  command.header.origin = origin_;
  command.action = action;
  command.reason = kReason;
  if (commands_->Write(command) != node::WriteStatus::kOk) {
    spdlog::warn("{} could not be written; it is repeated", NameOf(action));
  }
}

void OperatorDesk::PressSockets(std::int64_t now_ns) {
  if (idled_) return;
  std::vector<estop::Press> pressed;
  const auto sockets = estop::SocketsToPress(sockets_, node_.options().domain_id);
  pressed.reserve(sockets.size());
  for (const auto& path : sockets) pressed.emplace_back(path, kReason);
  std::size_t sent = 0, idle = 0;
  for (std::size_t i = 0; i < pressed.size(); ++i) {
    if (!pressed[i].sent()) continue;
    ++sent;
    const estop::Press::Answer answer = pressed[i].Await(estop::kAnswerLimit);
    if (answer.idle) ++idle;
    std::string text = answer.text.empty() ? "no answer" : answer.text;
    std::replace(text.begin(), text.end(), '\n', ' ');
    spdlog::info("{}: {}", sockets[i].string(), text);
  }
  idled_ = sent > 0 && idle == sent;
  // Without DDS the socket's answer counts.
  if (idled_ && !robot(now_ns)) action_.End(true, "");
}

std::optional<RobotState> OperatorDesk::robot(std::int64_t now_ns) const {
  return now_ns - heard_ns_ < kStateAge_ns ? robot_ : std::nullopt;
}

nlohmann::ordered_json OperatorDesk::Report() const {
  if (!action_.report()) return nullptr;
  const PendingAction::Report& report = *action_.report();
  return nlohmann::ordered_json{{"action", NameOf(report.action)},
                                {"pending", action_.pending()},
                                {"done", report.done},
                                {"why", report.why}};
}

}  // namespace sinew::live

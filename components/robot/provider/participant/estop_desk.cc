#include "components/robot/provider/participant/estop_desk.h"

#include <spdlog/spdlog.h>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/realtime.h"

namespace sinew::provider {

namespace {

void ReportOfEstop(bool is_error, const std::string& text) {
  if (is_error) {
    spdlog::error("{}", text);
  } else {
    spdlog::info("{}", text);
  }
}

}  // namespace

EstopDesk::EstopDesk(const estop::Config& config, ProviderCycle& cycle, Plant& plant,
                     std::function<void()> wake)
    : cycle_(cycle),
      plant_(plant),
      listener_(config, {.wake = std::move(wake), .report = &ReportOfEstop},
                node::PriorityOf("estop").priority) {
  if (config.socket) spdlog::info("estop: socket {}", config.socket->string());
  if (!listener_.at_start().latched) return;
  (void)cycle_.Take({.action = types::OperatorAction::kEstop}, 0);
  spdlog::warn("ESTOPPED by the latch of an earlier estop: {}; 'sinew reset' ends it",
               listener_.at_start().why);
}

void EstopDesk::Take(std::uint64_t tick) {
  if (listener_.TakePress()) {
    if (cycle_.state() !=
        types::RobotState::kEstopped) {  // a held button presses ten times a second
      const estop::Listener::Presser who = listener_.presser();
      spdlog::warn("tick {}: estop by the socket, of user {}, process {}", tick, who.user,
                   who.process);
    }
    (void)cycle_.Take({.action = types::OperatorAction::kEstop}, tick);
    OnEstop("socket");
  }
  if (!resets_) return;
  const estop::Listener::Unlatch unlatch = listener_.unlatch();
  if (unlatch == estop::Listener::Unlatch::kPending) return;
  resets_ = false;
  if (unlatch == estop::Listener::Unlatch::kFailed) {
    spdlog::error("reset refused: the latch of the estop cannot be removed; it stays ESTOPPED");
  } else if (cycle_.FinishReset()) {
    plant_.ClearFault();
  }
}

void EstopDesk::CommandSent() noexcept {
  if (sent_ != covered_) {
    sent_ = covered_;
    sent_ns_ = types::MonotonicNow_ns();
    listener_.IdleSent(sent_);
  }
  if (plant_.idle_reported_ns() >= sent_ns_) listener_.IdleConfirmed(sent_);
}

void EstopDesk::OnEstop(std::string_view reason) {
  resets_ = false;
  listener_.Latch(reason);
}

void EstopDesk::OnReset() {
  if (resets_) return;  // asked again: `sinew reset` repeats itself
  resets_ = true;
  listener_.RequestUnlatch();
}

}  // namespace sinew::provider

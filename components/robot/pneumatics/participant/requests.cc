#include "components/robot/pneumatics/participant/requests.h"

#include <cmath>

#include "components/base/types/motion.h"
#include "components/base/types/operator_action.h"
#include "components/base/types/state_archive.h"
#include "components/topics/node/codec.h"

namespace sinew::pneumatics {

PressureRequests::PressureRequests(node::Node& node, node::TickLoop& loop,
                                   const PneumaticsConfig& config)
    : loop_(loop),
      config_(config),
      requests_(node.MakeReader(node::kStiffnessRequest)),
      operator_(node.MakeReader(node::kOperatorCommand)),
      owner_(node, node::kPneumaticState) {
  for (std::size_t j = 0; j < config.joints.size(); ++j) {
    standing_target_bar_[j] = config.joints[j].target_bar;
  }
  // The requester publishes in every tick; one tick late, so that lockstep has no loop.
  if (config.motion_requests) {
    motion_ = &loop.AddInput(node::kMotionRequest, {.delay_ticks = 1, .required = true});
  }
}

bool PressureRequests::Take(const node::Tick& tick, types::Origin origin,
                            std::vector<PressureManager>* managers) {
  const types::RunningSession running{tick.session_id, origin};
  const bool is_new = tick.session_id != session_id_;
  if (is_new) {
    session_id_ = tick.session_id;
    estopped_ = false;
    for (std::size_t j = 0; j < managers->size(); ++j) {
      standing_target_bar_[j] = config_.joints[j].target_bar;
    }
  }
  TakeStiffness(running, managers);
  const bool asked = motion_ != nullptr && motion_->has_value() &&
                     static_cast<double>(tick.tick - motion_->tick()) * tick.nominal_period_s <=
                         config_.motion_timeout_s;
  FollowOwner(tick, asked);
  for (std::size_t j = 0; j < managers->size(); ++j) {
    double target_bar = standing_target_bar_[j];
    if (asked && j < motion_->value().joint_count &&
        motion_->value().kind[j] != types::Motion::kNone &&
        motion_->value().pressure_bar[j] > 0.0) {
      target_bar = motion_->value().pressure_bar[j];
    }
    (*managers)[j].RequestPressure(target_bar);
  }
  TakeOperator(running);
  return is_new;
}

void PressureRequests::TakeStiffness(const types::RunningSession& running,
                                     std::vector<PressureManager>* managers) {
  while (const auto request = requests_.TakeNext()) {
    if (!stiffness_gate_.Admits(types::CommandKind::kRequest, request->header, running)) {
      continue;
    }
    loop_.Used(node::EventId(*request));
    for (std::size_t j = 0; j < managers->size() && j < request->joint_count; ++j) {
      PressureManager& manager = (*managers)[j];
      bool good = true;
      if (request->kind[j] == msg::StiffnessKind::kPressure) {
        good = manager.RequestPressure(request->pressure_bar[j]);
      } else if (request->kind[j] == msg::StiffnessKind::kSecant) {
        good = manager.RequestStiffness(request->stiffness_Nm_rad[j]);
      } else {
        continue;
      }
      if (good) standing_target_bar_[j] = manager.target_bar();
    }
  }
}

// Requests from before this one was started are in the owner's targets. While a motion request sets
// them they are not what stands.
void PressureRequests::FollowOwner(const node::Tick& tick, bool asked) {
  while (const auto owner = owner_.TakeNext(tick)) {
    for (std::size_t j = 0; j < config_.joints.size() && j < owner->joint_count && !asked; ++j) {
      const double target_bar = owner->target_pressure_bar[j];
      if (std::isfinite(target_bar)) standing_target_bar_[j] = target_bar;
    }
  }
  standby_ = owner_.StandsBy(tick);
}

void PressureRequests::TakeOperator(const types::RunningSession& running) {
  reset_ = false;
  while (const auto command = operator_.TakeNext()) {
    const types::OperatorAction action = command->action;
    if (action == types::OperatorAction::kEstop) {
      estopped_ = true;
      loop_.Used(node::EventId(*command));
    }
    if (action == types::OperatorAction::kReset &&
        reset_gate_.Admits(types::CommandKind::kPermission, command->header, running)) {
      estopped_ = false;
      reset_ = true;
      loop_.Used(node::EventId(*command));
    }
  }
}

bool PressureRequests::MayHold(types::RobotState state) const {
  const bool quiet = state == types::RobotState::kDisarmed && config_.hold_disarmed;
  return (types::MayMove(state) || quiet) && !estopped_;
}

void PressureRequests::Exchange(types::StateArchive& archive) {
  archive(standing_target_bar_, estopped_, session_id_);
}

}  // namespace sinew::pneumatics

#include "components/robot/regime/participant/translate.h"

#include "components/base/types/motion.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"

namespace sinew::regime {

RobotRegime::RobotRegime(const std::vector<DetectorConfig>& joints) {
  for (const DetectorConfig& joint : joints) detectors.emplace_back(joint);
}

void RobotRegime::Follow(const node::Tick& tick, node::OtherOwner<msg::RegimeState>* owner) {
  while (const auto message = owner->TakeNext(tick)) {
    const Gaps& then = gaps_[message->header.tick % kTicksKept];
    if (!then.known || then.tick != message->header.tick) continue;
    for (std::size_t j = 0; j < detectors.size() && j < message->joint_count; ++j) {
      if (message->phase[j] != msg::RegimePhase::kExecution) continue;
      detectors[j].Adopt(tick.session_id, then.gap_rad[j] - message->play_angle_rad[j]);
    }
  }
  standby = owner->StandsBy(tick);
}

void RobotRegime::Step(const node::Tick& tick, const msg::JointState& state,
                       const node::TickInput<msg::ActuatorState>& actuator) {
  stale = !actuator.fresh();
  Gaps& gaps = gaps_[tick.tick % kTicksKept];
  gaps.tick = tick.tick;
  gaps.known = !stale;
  for (std::size_t j = 0; j < detectors.size(); ++j) {
    DetectorInput input;
    input.session_id = tick.session_id;
    input.period_s = tick.period_s;
    input.armed = !standby && types::MayMove(state.robot_state);
    if (!stale && j < state.joint_count && j < actuator.value().joint_count) {
      const msg::ActuatorState& inside = actuator.value();
      input.valid = state.valid[j] && inside.valid[j];
      input.motor_position_rad = inside.motor_position_rad[j];
      input.output_position_rad = state.position_rad[j];
      input.output_velocity_rad_s = state.velocity_rad_s[j];
      input.pressure_bar = inside.chamber_pressure_bar[j];
    }
    gaps.gap_rad[j] =
        input.motor_position_rad / detectors[j].config().gear_ratio - input.output_position_rad;
    gaps.known = gaps.known && input.valid;
    output[j] = detectors[j].Step(input);
  }
}

std::string RobotRegime::Trouble() const {
  for (std::size_t j = 0; j < detectors.size(); ++j) {
    if (output[j].trouble == Trouble::kNone) continue;
    return "joint " + std::to_string(j) + ": " + TroubleText(output[j].trouble);
  }
  return "";
}

void RobotRegime::Gaps::Exchange(types::StateArchive& archive) { archive(tick, known, gap_rad); }

// The output of a step is made anew.
void RobotRegime::Exchange(types::StateArchive& archive) { archive(detectors, gaps_); }

msg::RegimeState ToMessage(const RobotRegime& robot, const node::Tick& tick) {
  msg::RegimeState message;
  message.state_tick = tick.tick;
  message.stale = robot.stale;
  message.joint_count = static_cast<std::uint8_t>(robot.detectors.size());
  for (std::size_t j = 0; j < robot.detectors.size(); ++j) {
    const DetectorOutput& out = robot.output[j];
    message.phase[j] = out.phase;
    message.regime[j] = out.regime;
    message.contact[j] = out.contact;
    message.play_angle_rad[j] = out.alpha_rad;
    message.backlash_rad[j] = robot.detectors[j].config().play.backlash_rad;
    message.confidence[j] = out.confidence;
  }
  return message;
}

msg::MotionRequest ToRequest(const RobotRegime& robot) {
  msg::MotionRequest message;
  message.requester = "regime";
  message.joint_count = static_cast<std::uint8_t>(robot.detectors.size());
  for (std::size_t j = 0; j < robot.detectors.size(); ++j) {
    const DetectorOutput& out = robot.output[j];
    const DetectorConfig& config = robot.detectors[j].config();
    message.kind[j] = out.request;
    if (out.request == types::Motion::kNone) continue;
    message.target_rad[j] = out.request_target_rad;
    message.velocity_limit_rad_s[j] = config.velocity_rad_s;
    message.motor_torque_limit_Nm[j] =
        out.request == types::Motion::kHold ? 0.0 : config.motor_torque_limit_Nm;
    message.pressure_bar[j] = out.request_pressure_bar;
  }
  return message;
}

}  // namespace sinew::regime

#include "components/robot/performance/participant/robot_meter.h"

#include <array>
#include <limits>
#include <stdexcept>

#include "components/base/types/joints.h"

namespace sinew::performance {

bool RobotMeter::reads_actuators() const {
  for (const JointPerformanceConfig& joint : config_.robot.joints) {
    if (joint.motor.copper_resistance_Ohm > 0.0) return true;
  }
  return false;
}

void RobotMeter::Begin(const msg::JointState& state) {
  output_ = {};
  robot_.reset();
  unfit_.clear();
  session_id_ = state.header.session_id;
  since_tick_ = state.header.tick;
  const std::size_t joints = config_.robot.joints.size();
  if (state.joint_count < joints) {
    unfit_ = "the model has " + std::to_string(joints) + " joints, the robot " +
             std::to_string(state.joint_count);
    return;
  }
  try {
    robot_.emplace(config_.robot, state.period_s);
  } catch (const std::invalid_argument& error) {
    unfit_ = error.what();
  }
}

void RobotMeter::Step(const TickMessages& tick) {
  const msg::JointState& state = *tick.state;
  state_tick_ = state.header.tick;
  stale_ = tick.reference == nullptr || tick.reference->stale ||
           (reads_actuators() && tick.actuator == nullptr);
  if (!robot_ || state.header.session_id != session_id_) Begin(state);
  if (!robot_) return;
  constexpr double kLost = std::numeric_limits<double>::quiet_NaN();
  const std::size_t joints = config_.robot.joints.size();
  const bool asked = tick.reference != nullptr && !tick.reference->stale && !tick.reference->idle;
  std::array<JointSample, types::kMaxJoints> samples{};
  std::array<double, types::kMaxJoints> position{};
  for (std::size_t j = 0; j < joints; ++j) {
    const bool valid = j < state.joint_count && state.valid[j];
    position[j] = valid ? state.position_rad[j] : kLost;
    if (!valid) continue;
    JointSample& sample = samples[j];
    sample.position_rad = state.position_rad[j];
    sample.velocity_rad_s = state.velocity_rad_s[j];
    sample.torque_Nm = state.torque_Nm[j];
    if (asked && j < tick.reference->joint_count) {
      sample.reference_rad = tick.reference->position_rad[j];
    }
    if (tick.actuator != nullptr && j < tick.actuator->joint_count && tick.actuator->valid[j]) {
      sample.current_A = tick.actuator->motor_current_A[j];
    }
  }
  const double height_m =
      config_.height ? config_.height->Of(std::span(position).first(joints)) : kLost;
  output_ = robot_->Step(state_tick_, std::span(samples).first(joints), height_m);
}

msg::PerformanceState RobotMeter::ToMessage() const {
  msg::PerformanceState message;
  message.state_tick = state_tick_;
  message.since_tick = since_tick_;
  message.stale = stale_;
  message.joint_count = static_cast<std::uint8_t>(config_.robot.joints.size());
  for (std::size_t j = 0; j < config_.robot.joints.size(); ++j) {
    const JointPerformanceOutput& joint = output_.joint[j];
    message.error_known[j] = joint.error_known;
    message.error_rad[j] = joint.error_rad;
    message.sliding_rms_rad[j] = joint.sliding_rms_rad;
    message.window_share[j] = joint.window_share;
    message.mean_square_error_rad2[j] = joint.mean_square_error_rad2;
    message.error_samples[j] = joint.error_samples;
    message.absolute_work_J[j] = joint.energies.absolute_J;
    message.positive_work_J[j] = joint.energies.positive_J;
    message.net_work_J[j] = joint.energies.net_J;
    message.electrical_J[j] = joint.energies.electrical_drawn_J;
  }
  message.robot_mean_square_error_rad2 = output_.mean_square_error_rad2;
  message.robot_absolute_work_J = output_.energies.absolute_J;
  message.robot_positive_work_J = output_.energies.positive_J;
  message.robot_net_work_J = output_.energies.net_J;
  message.electrical_known = output_.energies.electrical_known;
  message.robot_electrical_J = output_.drawn_J;
  message.lifting_known = output_.lifting_known;
  message.rise_m = output_.rise_m;
  message.lifting_work_J = output_.lifting_J;
  return message;
}

}  // namespace sinew::performance

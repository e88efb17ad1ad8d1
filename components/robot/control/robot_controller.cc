#include "components/robot/control/robot_controller.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"

namespace sinew::control {

RobotController::RobotController(const std::vector<JointControlConfig>& joints) {
  if (joints.empty() || joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument(std::to_string(joints.size()) + " joints, expected 1 to " +
                                std::to_string(types::kMaxJoints));
  }
  for (const JointControlConfig& joint : joints) joints_.emplace_back(joint);
}

RobotOutput RobotController::Step(const RobotInput& input) noexcept {
  RobotOutput output;
  output.joint_count = joint_count();
  if (input.joint_count != joint_count()) {
    output.fault = Fault::kOtherRobot;
    return output;
  }
  if (!session_known_ || input.session_id != session_id_ || !input.armed) {
    session_known_ = true;
    session_id_ = input.session_id;
    reference_count_ = 0;
    for (JointController& joint : joints_) joint.Disarm();
  }
  if (!input.armed) {
    for (int j = 0; j < joint_count(); ++j) {
      const double position_rad = input.joint[j].position_rad;
      if (std::isfinite(position_rad)) output.joint[j].position_rad = position_rad;
    }
    return output;
  }
  if (input.reference_fresh || std::isfinite(input.reference_late_s)) {
    reference_count_ = input.reference_count;
  }

  bool off = false;
  for (int j = 0; j < joint_count(); ++j) {
    const JointInput joint{input,
                           &input.joint[j],
                           j < reference_count_,
                           input.reference[j],
                           input.prediction[j],
                           input.regime[j],
                           input.motion[j]};
    const JointController::Result result = joints_[j].Step(joint);
    output.joint[j] = result.output;
    output.stale = output.stale || result.stale;
    const JointControlConfig& config = joints_[j].config();
    const bool regime_known = input.regime_fresh || !config.needs_regime();
    if (UsesPrediction(config.strategy) && joint.reference_expected &&
        !(input.prediction_fresh && regime_known)) {
      output.stale = true;
    }
    if (result.fault != Fault::kNone &&
        (output.fault == Fault::kNone || result.fault <= Fault::kLastLatched)) {
      output.fault = result.fault;
      output.fault_joint = j;
    }
    off = off || (result.fault != Fault::kNone && result.fault <= Fault::kLastLatched);
  }
  if (!input.reference_fresh) output.stale = true;
  if (off) {
    output.stale = true;
    for (int j = 0; j < joint_count(); ++j) {
      const double position_rad = output.joint[j].position_rad;
      output.joint[j] = JointOutput{};
      output.joint[j].position_rad = position_rad;
    }
  }
  return output;
}

void RobotController::Follow(std::span<const double> difference_motor_torque_Nm) noexcept {
  for (std::size_t j = 0; j < std::min(joints_.size(), difference_motor_torque_Nm.size()); ++j) {
    joints_[j].Follow(difference_motor_torque_Nm[j]);
  }
}

}  // namespace sinew::control

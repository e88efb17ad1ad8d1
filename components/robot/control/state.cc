// The fields that are an object's state, once for both ways (types/state_archive.h).
#include "components/base/types/state_archive.h"
#include "components/robot/control/follower.h"
#include "components/robot/control/robot_controller.h"

namespace sinew::control {

void MeasuredJointState::Exchange(types::StateArchive& archive) {
  archive(valid, position_rad, velocity_rad_s, actuator_valid, motor_position_rad,
          motor_velocity_rad_s, pressure_bar, load_force_N, payload_kg, temperature_degC,
          valve_open);
}

void JointPrediction::Exchange(types::StateArchive& archive) {
  archive(valid, sea_torque_Nm, pea_torque_Nm, torque_Nm);
}

void MotionOrder::Exchange(types::StateArchive& archive) {
  archive(kind, target_rad, velocity_limit_rad_s, motor_torque_limit_Nm);
}

void Pid::Exchange(types::StateArchive& archive) {
  archive(integral_Nm_, derivative_Nm_, derivative_known_, output_Nm_);
}

void Compensator::Exchange(types::StateArchive& archive) {
  archive(memory_, time_s_, started_, pressure_bar_, pressure_rate_bar_s_, load_force_N_);
}

void Follower::Own::Exchange(types::StateArchive& archive) {
  archive(tick, known, motor_torque_Nm, given_Nm);
}

void Follower::Exchange(types::StateArchive& archive) {
  archive(own_, given_Nm_, session_id_, last_tick_);
}

void JointController::Exchange(types::StateArchive& archive) {
  archive(pid_, compensator_, started_, latched_, aim_, target_, offset_rad_, offset_age_s_,
          offset_fades_s_, replayed_, last_reference_, last_prediction_, last_regime_, motion_);
  bool moves = move_.has_value();
  archive(moves);
  if (archive.reads()) {
    move_.reset();
    if (moves) move_.emplace(reference::MoveConfig{});
  }
  if (move_) move_->Exchange(archive);
  archive(move_age_s_, push_at_rad_, last_position_rad_, last_position_known_, last_actuator_,
          source_, feed_forward_Nm_, fade_Nm_, integral_alone_Nm_);
}

void RobotController::Exchange(types::StateArchive& archive) {
  archive(joints_, session_id_, session_known_);
  archive.Bounded(reference_count_, types::kMaxJoints);
}

}  // namespace sinew::control

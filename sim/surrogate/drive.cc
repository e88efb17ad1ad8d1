#include "sim/surrogate/drive.h"

#include <algorithm>
#include <stdexcept>

namespace sinew::surrogate {

Drive::Drive(const DriveParameters& parameters)
    : parameters_(parameters), observer_(parameters.estimator_bandwidth_rad_s) {
  const DriveParameters& p = parameters;
  if (!(p.rate_Hz > 0.0) || !(p.position_gain_1_s >= 0.0) || !(p.velocity_gain_Nm_s_rad >= 0.0) ||
      !(p.velocity_integral_gain_Nm_rad >= 0.0) || !(p.velocity_limit_rad_s > 0.0) ||
      !(p.torque_limit_Nm > 0.0) || !(p.estimator_bandwidth_rad_s > 0.0)) {
    throw std::invalid_argument(
        "drive gains must not be negative, limits and rates must be positive");
  }
  if (p.estimator_bandwidth_rad_s > 0.5 * p.rate_Hz) {
    throw std::invalid_argument("estimator bandwidth is above half the drive's rate");
  }
}

void Drive::Reset(double motor_angle_rad) noexcept {
  observer_.Reset(motor_angle_rad);
  integral_Nm_ = 0.0;
  last_mode_ = types::ControlMode::kIdle;
}

double Drive::Step(const DriveCommand& command, double measured_angle_rad, double dt_s) noexcept {
  const DriveParameters& p = parameters_;
  observer_.Step(measured_angle_rad, dt_s);
  if (command.mode != last_mode_) integral_Nm_ = 0.0;
  last_mode_ = command.mode;
  double velocity_rad_s = command.velocity_rad_s;
  switch (command.mode) {
    case types::ControlMode::kIdle:
      return 0.0;
    case types::ControlMode::kTorque:
      return std::clamp(command.torque_Nm, -p.torque_limit_Nm, p.torque_limit_Nm);
    case types::ControlMode::kPosition:
      velocity_rad_s += p.position_gain_1_s * (command.position_rad - observer_.angle_rad());
      break;
    case types::ControlMode::kVelocity:
      break;
  }
  velocity_rad_s = std::clamp(velocity_rad_s, -p.velocity_limit_rad_s, p.velocity_limit_rad_s);
  const double error_rad_s = velocity_rad_s - observer_.velocity_rad_s();
  const double torque_Nm = p.velocity_gain_Nm_s_rad * error_rad_s + integral_Nm_;
  const double limited_Nm = std::clamp(torque_Nm, -p.torque_limit_Nm, p.torque_limit_Nm);
  if (torque_Nm == limited_Nm) {
    integral_Nm_ += p.velocity_integral_gain_Nm_rad * error_rad_s * dt_s;
  } else {
    integral_Nm_ *= 0.99;
  }
  return limited_Nm;
}

}  // namespace sinew::surrogate

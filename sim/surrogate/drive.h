// Motor controller in the manner of an ODrive 3.5: cascaded position, velocity and torque modes at
// the motor shaft, run at its own rate on its own encoder estimate.
//
//     velocity command = position_gain (position - estimate) + velocity feed-forward, limited
//     torque = velocity_gain (velocity command - estimate) + integral, limited
//
// Estimator: a phase-locked loop on encoder counts, critically damped as in the ODrive firmware (Kp
// = 2 b, Ki = Kp^2 / 4). It lags, as the real one does. One owner; no allocation; Step is noexcept.
#pragma once

#include "components/base/types/control_mode.h"

namespace sinew::surrogate {

// Second-order tracking observer of a measured angle.
class TrackingObserver {
 public:
  explicit TrackingObserver(double bandwidth_rad_s) noexcept
      : kp_(2.0 * bandwidth_rad_s), ki_(bandwidth_rad_s * bandwidth_rad_s) {}
  void Reset(double angle_rad) noexcept {
    angle_rad_ = angle_rad;
    velocity_rad_s_ = 0.0;
  }
  void Step(double measured_rad, double dt_s) noexcept {
    angle_rad_ += velocity_rad_s_ * dt_s;
    const double error_rad = measured_rad - angle_rad_;
    angle_rad_ += kp_ * error_rad * dt_s;
    velocity_rad_s_ += ki_ * error_rad * dt_s;
  }
  double angle_rad() const noexcept { return angle_rad_; }
  double velocity_rad_s() const noexcept { return velocity_rad_s_; }

 private:
  double kp_;
  double ki_;
  double angle_rad_ = 0.0;
  double velocity_rad_s_ = 0.0;
};

struct DriveParameters {
  double rate_Hz = 8000.0;
  double position_gain_1_s = 20.0;
  double velocity_gain_Nm_s_rad = 2e-3;
  double velocity_integral_gain_Nm_rad = 0.05;
  double velocity_limit_rad_s = 500.0;  // motor shaft
  double torque_limit_Nm = 0.398;       // motor shaft: 25 A
  double estimator_bandwidth_rad_s = 1000.0;
};

struct DriveCommand {
  types::ControlMode mode = types::ControlMode::kIdle;
  double torque_Nm = 0.0;       // kTorque
  double position_rad = 0.0;    // kPosition; motor shaft
  double velocity_rad_s = 0.0;  // kVelocity, and feed-forward of kPosition; motor shaft
};

class Drive {
 public:
  explicit Drive(const DriveParameters& parameters);  // throws std::invalid_argument

  void Reset(double motor_angle_rad) noexcept;
  // One cycle at rate_Hz on the encoder's reading. Returns the torque reference, N·m at the motor
  // shaft.
  double Step(const DriveCommand& command, double measured_angle_rad, double dt_s) noexcept;

  double velocity_estimate_rad_s() const noexcept { return observer_.velocity_rad_s(); }

 private:
  DriveParameters parameters_;
  TrackingObserver observer_;
  double integral_Nm_ = 0.0;
  types::ControlMode last_mode_ = types::ControlMode::kIdle;
};

}  // namespace sinew::surrogate

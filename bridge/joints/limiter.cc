#include "bridge/joints/limiter.h"

#include <algorithm>

namespace sinew::bridge {
namespace {

bool IsOutwards(const JointLimits& limits, double position_rad, double command) {
  return (command > 0.0 && position_rad > limits.upper_rad) ||
         (command < 0.0 && position_rad < limits.lower_rad);
}

}  // namespace

double LimitTorque(const JointLimits& limits, double torque_constant_Nm_A,
                   const MeasuredMotion& measured, double torque_Nm) {
  const double most_Nm = std::min(limits.motor_torque_Nm, limits.current_A * torque_constant_Nm_A);
  const double clamped_Nm = std::clamp(torque_Nm, -most_Nm, most_Nm);
  const double forward_rad_s =
      clamped_Nm > 0.0 ? measured.velocity_rad_s : -measured.velocity_rad_s;
  const double share = (limits.velocity_rad_s - forward_rad_s) / (kTaper * limits.velocity_rad_s);
  const double tapered_Nm = clamped_Nm * std::clamp(share, 0.0, 1.0);
  return IsOutwards(limits, measured.position_rad, tapered_Nm) ? 0.0 : tapered_Nm;
}

double LimitVelocity(const JointLimits& limits, double position_rad, double velocity_rad_s) {
  const double clamped_rad_s =
      std::clamp(velocity_rad_s, -limits.velocity_rad_s, limits.velocity_rad_s);
  return IsOutwards(limits, position_rad, clamped_rad_s) ? 0.0 : clamped_rad_s;
}

PositionSetpoint LimitPosition(const JointLimits& limits, double last_rad, double period_s,
                               const PositionSetpoint& command) {
  const double wanted_rad = std::clamp(command.position_rad, limits.lower_rad, limits.upper_rad);
  const double step_rad = limits.velocity_rad_s * period_s;
  PositionSetpoint next;
  next.position_rad = last_rad + std::clamp(wanted_rad - last_rad, -step_rad, step_rad);
  const bool reached = wanted_rad == command.position_rad && next.position_rad == wanted_rad;
  if (reached) {
    next.velocity_rad_s =
        std::clamp(command.velocity_rad_s, -limits.velocity_rad_s, limits.velocity_rad_s);
  }
  return next;
}

}  // namespace sinew::bridge

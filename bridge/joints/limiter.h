// The limits of torque, velocity and position, whatever is commanded. Pure functions of limits,
// command and measurement; any thread; they allocate nothing.
//
// Velocities and positions are those of the output, positive up; torque is that of the motor shaft,
// positive drives the output up. Inputs must be finite.
#pragma once

#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

// Torque is tapered to nothing over this part of the velocity limit, below it.
inline constexpr double kTaper = 0.1;

struct MeasuredMotion {
  double velocity_rad_s = 0.0;  // by the motor: the output's is noisier, and inside the play it
                                // says nothing
  double position_rad = 0.0;
};

// |T| <= min(limit, current limit * torque constant); times
// clamp((v_limit - v) / (kTaper v_limit), 0, 1) with v in the direction of T; nothing outwards
// beyond a position limit.
double LimitTorque(const JointLimits& limits, double torque_constant_Nm_A,
                   const MeasuredMotion& measured, double torque_Nm);

// |v| <= limit; nothing outwards beyond a position limit.
double LimitVelocity(const JointLimits& limits, double position_rad, double velocity_rad_s);

struct PositionSetpoint {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;  // feed-forward
};

// The setpoint after `last_rad`: within the position limits and no further from the last one than
// the velocity limit allows in a period. The commanded velocity, within its limit, is fed forward
// only where the position is the commanded one.
PositionSetpoint LimitPosition(const JointLimits& limits, double last_rad, double period_s,
                               const PositionSetpoint& command);

}  // namespace sinew::bridge

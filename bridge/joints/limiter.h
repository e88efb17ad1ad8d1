// The limits of torque, velocity and position, whatever is commanded. Pure functions of limits,
// command and measurement; any thread; they allocate nothing.
//
// Velocities and positions are those of the output, positive up; torque is that of the motor shaft,
// positive drives the output up. Inputs must be finite. How a position limit is approached is
// derived in README.md.
#pragma once

#include "bridge/joints/braking.h"
#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

// Torque is tapered to nothing over this part of the velocity limit, below it.
inline constexpr double kTaper = 0.1;

struct MeasuredMotion {
  double velocity_rad_s = 0.0;  // by the motor: the output's is noisier, and inside the play it
                                // says nothing
  double position_rad = 0.0;
  double unknown_s = 0.0;  // age of the older of both beyond a period, which the envelope has
};

// |T| <= min(limit, current limit * torque constant); times
// clamp((v_limit - v) / (kTaper v_limit), 0, 1) with v in the direction of T. Towards a position
// limit at most what the envelope allows, and braking torque where that is negative; for a joint
// whose inertia is not declared v_limit is no more than the envelope's velocity, and there is no
// torque outwards beyond the limit.
double LimitTorque(const JointLimits& limits, const Envelope& envelope, const PositionRange& range,
                   const MeasuredMotion& measured, double torque_Nm);

// |v| <= limit; towards a position limit at most the envelope's velocity, nothing beyond it. How
// well that is followed is up to the drive's own velocity loop.
double LimitVelocity(const JointLimits& limits, const Envelope& envelope,
                     const MeasuredMotion& measured, double velocity_rad_s);

struct PositionSetpoint {
  double position_rad = 0.0;
  double velocity_rad_s = 0.0;  // feed-forward
};

// The setpoint after `last_rad`: within the position limits and no further from the last one than
// the velocity limit, and towards a position limit the envelope, allows in a period. The commanded
// velocity, within the same limits, is fed forward only where the position is the commanded one.
PositionSetpoint LimitPosition(const JointLimits& limits, const Envelope& envelope, double last_rad,
                               double period_s, const PositionSetpoint& command);

}  // namespace sinew::bridge

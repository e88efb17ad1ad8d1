// The braking envelope of a position limit: how fast a joint may approach it, and the torque that
// keeps it so. Pure functions; any thread; they allocate nothing.
//
// Output side, the direction towards the limit positive; d: distance to the limit less what the
// joint travels in the latency, d = distance - max(v, 0) L. A torque that is computed now acts
// after the command delay and for a period, until the next one acts:
//
//     L       = command delay + period                        all of it at the present velocity
//     a       = (efficiency N T_max - load) / J_max           what the motor can brake in any case:
//                                                             gravity and load outwards, the worst
//                                                             inertia, friction neglected (it
//                                                             helps)
//     v(d)    = sqrt(2 a (d - a / (2 k^2)))   d > a / k^2     stops at the limit with a
//             = k d                           else            its last part, which a torque that is
//                                                             L late can follow; its tangent there,
//                                                             so that v(d) <= sqrt(2 a d)
//                                                             throughout
//     cap     = K (v(d) - v) - N T_max min(1, max(v, 0) k / a)
//     torque  = min(commanded, cap / N), within the motor's limits
//
//     K = 0.7 J_r / L,  k = min(0.25, 0.7 J_r a / (N T_max)) / L     J_r: rotor's, reflected
//
// Beyond the limit v(d) = k d < 0: a spring of stiffness K k that pushes back. An old measurement
// (MeasuredMotion::unknown_s) is braked from the worst motion that it allows; the torque outwards
// of a joint without declared inertia is only taken away. Derivation: README.md.
#pragma once

#include "bridge/joints/joint_config.h"

namespace sinew::bridge {

struct Envelope {
  double deceleration_rad_s2 = 0.0;  // a
  double acceleration_rad_s2 = 0.0;  // the most outwards: (N T_max + load) / J_r; 0: not declared
  double approach_1_s = 0.0;         // k
  double gain_Nm_s_rad = 0.0;        // K, output; 0: inertia is not declared
  double latency_s = 0.0;            // L
  double motor_torque_Nm = 0.0;      // T_max: of torque and current limit the smaller
  double gear_ratio = 1.0;           // N
  double load_beyond_rad = 0.0;      // the tolerance, without play; 0 where not declared

  bool brakes() const { return gain_Nm_s_rad > 0.0; }
};

// The joint must have passed CheckBridgeConfig.
Envelope EnvelopeOf(const JointConfig& joint, double period_s);

// a; not above 0: the motor cannot brake the declared load.
double BrakingDeceleration(const JointConfig& joint);

// v(d). Negative beyond the limit for a joint that brakes, 0 there for others.
double EnvelopeVelocity(const Envelope& envelope, double distance_rad);

// d: `distance_rad` less the way in the latency.
double DistanceAfterLatency(const Envelope& envelope, double distance_rad, double velocity_rad_s);

// The largest motor torque towards the limit, within +-T_max; negative: braking is needed. For an
// envelope that brakes.
double LargestTorque(const Envelope& envelope, double distance_rad, double velocity_rad_s);

// The positions that a joint may have. A joint that is armed outside its limits must not be thrown
// back: the limit is where it is, and follows it inwards until it is the declared one.
struct PositionRange {
  double lower_rad = 0.0;
  double upper_rad = 0.0;
};
PositionRange RangeFrom(const JointLimits& limits, double position_rad);
PositionRange Narrowed(const JointLimits& limits, const PositionRange& range, double position_rad);

}  // namespace sinew::bridge

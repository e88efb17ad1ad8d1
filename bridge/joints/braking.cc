#include "bridge/joints/braking.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sinew::bridge {
namespace {

// Slope L / J of each term; twice it is below pi / 2, the limit of stability: see the header.
constexpr double kGainOfEach = 0.7;
constexpr double kSlowest = 0.25;

double MotorTorqueLimit(const JointConfig& joint) {
  return std::min(joint.limits.motor_torque_Nm,
                  joint.limits.current_A * joint.torque_constant_Nm_A);
}

}  // namespace

double BrakingDeceleration(const JointConfig& joint) {
  const JointLimits& limits = joint.limits;
  if (!limits.braking) {
    return limits.margin_rad > 0.0
               ? limits.velocity_rad_s * limits.velocity_rad_s / (2.0 * limits.margin_rad)
               : std::numeric_limits<double>::infinity();
  }
  const double braking_Nm = joint.torque_efficiency * joint.gear_ratio * MotorTorqueLimit(joint);
  return (braking_Nm - limits.braking->load_torque_Nm) / limits.braking->max_inertia_kg_m2;
}

Envelope EnvelopeOf(const JointConfig& joint, double period_s) {
  Envelope e;
  e.motor_torque_Nm = MotorTorqueLimit(joint);
  e.gear_ratio = joint.gear_ratio;
  e.deceleration_rad_s2 = BrakingDeceleration(joint);
  const auto& braking = joint.limits.braking;
  e.latency_s = (braking ? braking->command_delay_s : Braking{}.command_delay_s) + period_s;
  if (!braking) return e;
  const double lightest = braking->reflected_inertia_kg_m2;
  e.acceleration_rad_s2 =
      (joint.gear_ratio * e.motor_torque_Nm + braking->load_torque_Nm) / lightest;
  e.gain_Nm_s_rad = kGainOfEach * lightest / e.latency_s;
  e.approach_1_s = std::min(kSlowest, kGainOfEach * lightest * e.deceleration_rad_s2 /
                                          (joint.gear_ratio * e.motor_torque_Nm)) /
                   e.latency_s;
  e.load_beyond_rad =
      braking->load_torque_Nm / (joint.torque_efficiency * e.gain_Nm_s_rad * e.approach_1_s);
  return e;
}

double EnvelopeVelocity(const Envelope& e, double distance_rad) {
  const double a = e.deceleration_rad_s2;
  if (!e.brakes()) {
    if (distance_rad <= 0.0) return 0.0;
    return std::sqrt(2.0 * a * distance_rad);
  }
  const double k = e.approach_1_s;
  if (distance_rad <= a / (k * k)) return k * distance_rad;
  return std::sqrt(2.0 * a * (distance_rad - 0.5 * a / (k * k)));
}

double DistanceAfterLatency(const Envelope& e, double distance_rad, double velocity_rad_s) {
  return distance_rad - std::max(velocity_rad_s, 0.0) * e.latency_s;
}

double LargestTorque(const Envelope& e, double distance_rad, double velocity_rad_s) {
  const double allowed_rad_s =
      EnvelopeVelocity(e, DistanceAfterLatency(e, distance_rad, velocity_rad_s));
  const double along =
      std::min(1.0, std::max(velocity_rad_s, 0.0) * e.approach_1_s / e.deceleration_rad_s2);
  const double cap_Nm =
      e.gain_Nm_s_rad * (allowed_rad_s - velocity_rad_s) / e.gear_ratio - e.motor_torque_Nm * along;
  return std::clamp(cap_Nm, -e.motor_torque_Nm, e.motor_torque_Nm);
}

PositionRange RangeFrom(const JointLimits& limits, double position_rad) {
  return {std::min(limits.lower_rad, position_rad), std::max(limits.upper_rad, position_rad)};
}

PositionRange Narrowed(const JointLimits& limits, const PositionRange& range, double position_rad) {
  return {std::min(limits.lower_rad, std::max(range.lower_rad, position_rad)),
          std::max(limits.upper_rad, std::min(range.upper_rad, position_rad))};
}

}  // namespace sinew::bridge

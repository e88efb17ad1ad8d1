#include "bridge/joints/limiter.h"

#include <algorithm>
#include <cmath>

namespace sinew::bridge {
namespace {

// A setpoint so near to the wanted one is it: the envelope's last part has no end.
constexpr double kArrived_rad = 1e-6;

double Taper(double limit_rad_s, double forward_rad_s) {
  if (limit_rad_s <= 0.0) return 0.0;
  return std::clamp((limit_rad_s - forward_rad_s) / (kTaper * limit_rad_s), 0.0, 1.0);
}

// The largest velocity towards each limit, from a distance to it.
double FastestOutwards(const JointLimits& limits, const Envelope& envelope, double distance_rad) {
  return std::clamp(EnvelopeVelocity(envelope, distance_rad), 0.0, limits.velocity_rad_s);
}

double ClampVelocity(const JointLimits& limits, const Envelope& envelope, double to_lower_rad,
                     double to_upper_rad, double velocity_rad_s) {
  return std::clamp(velocity_rad_s, -FastestOutwards(limits, envelope, to_lower_rad),
                    FastestOutwards(limits, envelope, to_upper_rad));
}

// Motion towards a limit at the end of the unknown time.
struct Approach {
  double distance_rad = 0.0;
  double velocity_rad_s = 0.0;
};

Approach GoneOn(Approach measured, double unknown_s) {
  measured.distance_rad -= std::max(measured.velocity_rad_s, 0.0) * unknown_s;
  return measured;
}

Approach AtWorst(const JointLimits& limits, const Envelope& e, Approach measured,
                 double unknown_s) {
  const double v = measured.velocity_rad_s, fastest = std::max(v, limits.velocity_rad_s);
  const double gained = e.acceleration_rad_s2 * unknown_s;
  const double way = std::min(v + 0.5 * gained, fastest) * unknown_s;
  return {measured.distance_rad - std::max(way, 0.0), std::min(v + gained, fastest)};
}

// Towards a limit: braking by where the joint has gone on to, no torque outwards that the worst
// forbids.
double LargestTorque(const JointLimits& limits, const Envelope& e, Approach measured,
                     double unknown_s) {
  const Approach on = GoneOn(measured, unknown_s);
  const Approach worst = AtWorst(limits, e, measured, unknown_s);
  return std::min(LargestTorque(e, on.distance_rad, on.velocity_rad_s),
                  std::max(0.0, LargestTorque(e, worst.distance_rad, worst.velocity_rad_s)));
}

}  // namespace

double LimitTorque(const JointLimits& limits, const Envelope& envelope, const PositionRange& range,
                   const MeasuredMotion& measured, double torque_Nm) {
  const double most_Nm = envelope.motor_torque_Nm;
  const double clamped_Nm = std::clamp(torque_Nm, -most_Nm, most_Nm);
  const double v = measured.velocity_rad_s;
  const Approach up{range.upper_rad - measured.position_rad, v};
  const Approach down{measured.position_rad - range.lower_rad, -v};
  const Approach outwards =
      AtWorst(limits, envelope, clamped_Nm > 0.0 ? up : down, measured.unknown_s);
  double fastest_rad_s = limits.velocity_rad_s;
  if (!envelope.brakes()) {
    fastest_rad_s = FastestOutwards(
        limits, envelope,
        DistanceAfterLatency(envelope, outwards.distance_rad, outwards.velocity_rad_s));
  }
  const double tapered_Nm = clamped_Nm * Taper(fastest_rad_s, outwards.velocity_rad_s);
  if (!envelope.brakes()) return tapered_Nm;
  const double most_up_Nm = LargestTorque(limits, envelope, up, measured.unknown_s);
  const double most_down_Nm = -LargestTorque(limits, envelope, down, measured.unknown_s);
  // The limit that the joint moves to has the last word.
  return v >= 0.0 ? std::min(std::max(tapered_Nm, most_down_Nm), most_up_Nm)
                  : std::max(std::min(tapered_Nm, most_up_Nm), most_down_Nm);
}

double LimitVelocity(const JointLimits& limits, const Envelope& envelope,
                     const MeasuredMotion& measured, double velocity_rad_s) {
  const double v = measured.velocity_rad_s;
  const auto distance_rad = [&](double to_limit_rad, double towards_rad_s) {
    const Approach on = GoneOn({to_limit_rad, towards_rad_s}, measured.unknown_s);
    return DistanceAfterLatency(envelope, on.distance_rad, on.velocity_rad_s);
  };
  return ClampVelocity(limits, envelope, distance_rad(measured.position_rad - limits.lower_rad, -v),
                       distance_rad(limits.upper_rad - measured.position_rad, v), velocity_rad_s);
}

PositionSetpoint LimitPosition(const JointLimits& limits, const Envelope& envelope, double last_rad,
                               double period_s, const PositionSetpoint& command) {
  const double wanted_rad = std::clamp(command.position_rad, limits.lower_rad, limits.upper_rad);
  const double way_rad = wanted_rad - last_rad;
  // From outside it comes back at the velocity limit; the other limit's envelope is far away.
  const double step_rad = period_s * FastestOutwards(limits, envelope,
                                                     way_rad > 0.0 ? limits.upper_rad - last_rad
                                                                   : last_rad - limits.lower_rad);
  PositionSetpoint next;
  next.position_rad = std::abs(way_rad) <= kArrived_rad
                          ? wanted_rad
                          : last_rad + std::clamp(way_rad, -step_rad, step_rad);
  const bool reached = wanted_rad == command.position_rad && next.position_rad == wanted_rad;
  if (reached) {
    next.velocity_rad_s =
        ClampVelocity(limits, envelope, next.position_rad - limits.lower_rad,
                      limits.upper_rad - next.position_rad, command.velocity_rad_s);
  }
  return next;
}

}  // namespace sinew::bridge

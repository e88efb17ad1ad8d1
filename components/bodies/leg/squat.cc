#include "components/bodies/leg/squat.h"

#include <algorithm>
#include <cmath>

namespace sinew::leg {

double StraightHeight(const LegGeometry& geometry, double foot_forward_m) noexcept {
  const double longest = geometry.thigh_m + geometry.shank_m;
  return std::sqrt(std::max(0.0, (longest - foot_forward_m) * (longest + foot_forward_m)));
}

std::optional<SquatMotion> SquatAt(const LegGeometry& geometry, double foot_forward_m,
                                   const HipHeight& hip) noexcept {
  constexpr double kSmallestSine = 1e-6;
  const double a = geometry.thigh_m, b = geometry.shank_m, x = foot_forward_m;
  const double h = hip.height_m, dh = hip.velocity_m_s, ddh = hip.acceleration_m_s2;
  const double u = x * x + h * h, du = 2.0 * h * dh, ddu = 2.0 * (dh * dh + h * ddh);
  const double cosine = (u - a * a - b * b) / (2.0 * a * b);
  // Written so that NaN is refused.
  if (!(std::abs(cosine) < 1.0) || !std::isfinite(du) || !std::isfinite(ddu) || !(h > 0.0)) {
    return std::nullopt;
  }
  const double sine = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  if (!(sine > kSmallestSine)) return std::nullopt;

  SquatMotion out;
  out.knee.position_rad = std::atan2(sine, cosine);
  out.knee.velocity_rad_s = -du / (2.0 * a * b) / sine;
  const double knee_square = out.knee.velocity_rad_s * out.knee.velocity_rad_s;
  out.knee.acceleration_rad_s2 = -(ddu / (2.0 * a * b) + cosine * knee_square) / sine;

  // First and second derivative of the angle of the line from hip to ankle, atan2(-x, h).
  const double line_rate = x * dh / u;
  const double line_curvature = x * (ddh * u - dh * du) / (u * u);
  const double g = (b * b + a * b * cosine) / u;
  const double dg = a * b * sine * (b * b - a * a) / (u * u);
  out.hip_pitch.position_rad = std::atan2(-x, h) - std::atan2(b * sine, a + b * cosine);
  out.hip_pitch.velocity_rad_s = line_rate - g * out.knee.velocity_rad_s;
  out.hip_pitch.acceleration_rad_s2 =
      line_curvature - g * out.knee.acceleration_rad_s2 - dg * knee_square;

  out.ankle_pitch.position_rad = -out.hip_pitch.position_rad - out.knee.position_rad;
  out.ankle_pitch.velocity_rad_s = -out.hip_pitch.velocity_rad_s - out.knee.velocity_rad_s;
  out.ankle_pitch.acceleration_rad_s2 =
      -out.hip_pitch.acceleration_rad_s2 - out.knee.acceleration_rad_s2;
  return out;
}

}  // namespace sinew::leg

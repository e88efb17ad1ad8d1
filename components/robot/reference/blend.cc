#include "components/robot/reference/blend.h"

namespace sinew::reference {

BlendWeight Blend(double time_s, double duration_s) noexcept {
  if (!(time_s < duration_s)) return {1.0, 0.0, 0.0};
  if (!(time_s > 0.0)) return {};
  const double rate = 1.0 / duration_s;
  const double u = time_s * rate;
  return {u * u * u * (10.0 + u * (-15.0 + 6.0 * u)), rate * 30.0 * u * u * (1.0 + u * (u - 2.0)),
          rate * rate * 60.0 * u * (1.0 + u * (-3.0 + 2.0 * u))};
}

Point Mix(const Point& from, const Point& to, const BlendWeight& w) noexcept {
  const double gap = to.position_rad - from.position_rad;
  const double gap_rate = to.velocity_rad_s - from.velocity_rad_s;
  Point mixed;
  mixed.position_rad = from.position_rad + w.value * gap;
  mixed.velocity_rad_s = from.velocity_rad_s + w.rate_per_s * gap + w.value * gap_rate;
  mixed.acceleration_rad_s2 = from.acceleration_rad_s2 + w.curvature_per_s2 * gap +
                              2.0 * w.rate_per_s * gap_rate +
                              w.value * (to.acceleration_rad_s2 - from.acceleration_rad_s2);
  return mixed;
}

}  // namespace sinew::reference

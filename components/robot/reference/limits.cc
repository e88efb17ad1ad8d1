#include "components/robot/reference/limits.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::reference {

Extremes Measure(const Trajectory& trajectory, double horizon_s) {
  constexpr double kStep_s = 1e-3;
  const double end_s = std::isfinite(trajectory.duration_s()) ? trajectory.duration_s() : horizon_s;
  const auto count = static_cast<long>(std::ceil(end_s / kStep_s));
  const Point first = trajectory.At(0.0);
  Extremes extremes{first.position_rad, first.position_rad, 0.0, 0.0};
  for (long i = 0; i <= count; ++i) {
    const Point p = trajectory.At(std::min(end_s, static_cast<double>(i) * kStep_s));
    extremes.position_lower_rad = std::min(extremes.position_lower_rad, p.position_rad);
    extremes.position_upper_rad = std::max(extremes.position_upper_rad, p.position_rad);
    extremes.velocity_rad_s = std::max(extremes.velocity_rad_s, std::abs(p.velocity_rad_s));
    extremes.acceleration_rad_s2 =
        std::max(extremes.acceleration_rad_s2, std::abs(p.acceleration_rad_s2));
  }
  return extremes;
}

double FittingFactor(const Extremes& extremes, double center_rad, const Limits& limits) {
  if (center_rad < limits.position_lower_rad || center_rad > limits.position_upper_rad) {
    throw std::invalid_argument("center " + std::to_string(center_rad) +
                                " lies outside the limits " +
                                std::to_string(limits.position_lower_rad) + " to " +
                                std::to_string(limits.position_upper_rad));
  }
  double factor = 1.0;
  const auto fit = [&factor](double demand, double limit) {
    if (demand > limit) factor = std::min(factor, limit / demand);
  };
  fit(extremes.position_upper_rad - center_rad, limits.position_upper_rad - center_rad);
  fit(center_rad - extremes.position_lower_rad, center_rad - limits.position_lower_rad);
  fit(extremes.velocity_rad_s, limits.velocity_rad_s);
  fit(extremes.acceleration_rad_s2, limits.acceleration_rad_s2);
  return factor;
}

}  // namespace sinew::reference

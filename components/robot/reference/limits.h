// Checks a trajectory against a joint's limits, and finds the factor that scales it so that it
// does?
//
// Found on a grid of 1 ms over the trajectory (endless ones: over the horizon given). Set-up only.
#pragma once

#include <limits>

#include "components/robot/reference/trajectory.h"

namespace sinew::reference {

struct Limits {
  double position_lower_rad = -std::numeric_limits<double>::infinity();
  double position_upper_rad = std::numeric_limits<double>::infinity();
  double velocity_rad_s = std::numeric_limits<double>::infinity();
  double acceleration_rad_s2 = std::numeric_limits<double>::infinity();
};

struct Extremes {
  double position_lower_rad = 0.0;
  double position_upper_rad = 0.0;
  double velocity_rad_s = 0.0;       // largest magnitude
  double acceleration_rad_s2 = 0.0;  // largest magnitude
};

Extremes Measure(const Trajectory& trajectory, double horizon_s);

// Largest factor in [0, 1] such that center + factor (trajectory - center) keeps every limit.
// Throws std::invalid_argument when the center itself lies outside the position limits.
double FittingFactor(const Extremes& extremes, double center_rad, const Limits& limits);

}  // namespace sinew::reference

// Smooth passage from 0 to 1: the quintic of least jerk, and its derivatives.
//
//     w(u) = 10 u^3 - 15 u^4 + 6 u^5,  u = t / T in [0, 1]
//
// Value, first and second derivative are 0 at u = 0; 1, 0 and 0 at u = 1 (Flash and Hogan 1985).
// Thread: free functions. Allocates nothing.
#pragma once

#include "components/robot/reference/trajectory.h"

namespace sinew::reference {

struct BlendWeight {
  double value = 0.0;
  double rate_per_s = 0.0;
  double curvature_per_s2 = 0.0;
};

// Weight at time_s of a passage that takes duration_s; a duration of 0 or less is a jump at time 0.
BlendWeight Blend(double time_s, double duration_s) noexcept;

// (1 - w) from + w to, with velocity and acceleration by the product rule.
Point Mix(const Point& from, const Point& to, const BlendWeight& w) noexcept;

}  // namespace sinew::reference

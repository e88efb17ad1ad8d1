// What the squat test found, as a section of a page: tables 6.6, 6.7 and 7.1, Figs 6.14, 6.20 to
// 6.22, 7.5, 7.7, 7.8 and 7.10, published values beside ours. Pure text.
#pragma once

#include <vector>

#include "components/model/report/section.h"
#include "reproduction/squat_test/runner.h"

namespace sinew::squat_test {

// Throws std::invalid_argument when an arm that a comparison needs is missing: PID, PID + ESN and
// computed torque without load, computed torque and the adapted one with it. `six` may be empty.
report::Section MakeSection(const std::vector<Squats>& benchmark, const std::vector<Squats>& six);

// Squats after the load was put on beside the last one before, by root mean square error.
struct Recovery {
  double before_rad = 0.0;
  std::vector<double> after_rad;  // of each squat
  // After which the sliding error (7.7) stays within a tenth of the largest value that it has in
  // the last squat; s since the load was put on. Nothing: it does not.
  std::optional<double> settled_s;
};
Recovery RecoveryOf(const Squats& squats);

}  // namespace sinew::squat_test

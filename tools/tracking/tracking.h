// Tracking error and effort of a recorded joint.
//
// Trapezoidal integrals over the samples' own times t_i, from `from_s` after the first sample:
//   mean square error   1/T int (q_ref - q)^2 dt
//   torque              sqrt(1/T int tau^2 dt), tau the measured drive torque at the output
//   current             sqrt(1/T int I^2 dt)
//   work                int max(tau dq/dt, 0) dt: positive mechanical work at the output
// Pure; throws std::invalid_argument when a signal is missing or fewer than two samples remain.
#pragma once

#include "components/base/types/run.h"

namespace sinew::tools {

struct TrackingScore {
  double duration_s = 0.0;
  double mean_square_error_rad2 = 0.0;  // m2 for a linear joint
  double rms_error_rad = 0.0;
  double max_error_rad = 0.0;
  bool has_current = false;
  double rms_current_A = 0.0;
  bool has_torque = false;     // the next two are known
  double rms_torque_Nm = 0.0;  // N for a linear joint
  double positive_work_J = 0.0;
};

TrackingScore ScoreTracking(const types::Run& run, double from_s = 0.0);

}  // namespace sinew::tools

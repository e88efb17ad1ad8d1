// Tracking errors and energies of recorded sessions, as `sinew-performance` measures them live.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/sinew/performance_section.h"

namespace sinew::tools {

struct MeasureOptions {
  std::string config;  // sinew-performance/1
  std::optional<double> event_s =
      std::nullopt;        // settle times after this, since each session's first tick
  double band_rad = 0.01;  // settled: within this of the plateau
};

// All sessions of the files, in order. Throws UsageError: a file that cannot be read, was recorded
// by a build with other fields, holds no joint_state or does not fit the configuration.
std::vector<MeasuredSession> MeasureRecordings(const std::vector<std::string>& files,
                                               const MeasureOptions& options);

}  // namespace sinew::tools

// A fit done the way a publication did it, for a comparison with its figures: zero-phase
// Butterworth filter on position, two-point central differences, border samples dropped, regressors
// built at the full rate, the drive and every column decimated as MATLAB does, ordinary least
// squares. No sample is left out, no delay is aligned. Pure; allocates; throws
// std::invalid_argument.
#pragma once

#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"

namespace sinew::identify {

struct AsPublishedOptions {
  int filter_order = 4;
  double cutoff_Hz = 100.0;
  int border_samples = 0;
  int decimate = 1;
  std::vector<std::string> added_effects;
};

// Relative errors 100 |y - y_model| / |y| of the drive.
struct AsPublishedResult {
  double before_percent = 0.0;
  double after_percent = 0.0;
  double cross_before_percent = 0.0;  // parameters of train, data of cross
  double cross_after_percent = 0.0;
  actuator::JointModel before;  // fitted
  actuator::JointModel after;
};

AsPublishedResult RunAsPublished(const types::Run& train, const types::Run& cross,
                                 const actuator::JointModel& model,
                                 const AsPublishedOptions& options);

}  // namespace sinew::identify

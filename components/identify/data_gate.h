// What a recording is like before anything is fitted to it: stamps, lost rows, saturation,
// resolution, and lags between channels that should say the same. Findings are told, never silently
// mended. Pure; allocates.
#pragma once

#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/processing.h"
#include "components/identify/run.h"

namespace sinew::identify {

struct Finding {
  std::string name;  // stable, e.g. "lost_rows"
  std::string text;  // one sentence
  double value = 0.0;
  std::string unit;
};

// states: made of the same runs.
std::vector<Finding> ExamineData(const std::vector<Run>& runs, const StateSet& states,
                                 const actuator::JointModel& model);

// Lag of a measured velocity behind the derivative of the position, by least squares on
// v_measured = v - lag * a; positive: late. Over samples faster than `least_speed`.
double VelocityLag(const Eigen::Ref<const Eigen::VectorXd>& measured,
                   const Eigen::Ref<const Eigen::VectorXd>& velocity,
                   const Eigen::Ref<const Eigen::VectorXd>& acceleration, double least_speed);

}  // namespace sinew::identify

// Signals of a standing robot: low-pass and derivative, as those of the angles of joints
// (identify/processing.h), of columns of a matrix whose rows are on an even grid; an orientation
// without its heading; whether a joint travels. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/identify/differentiate.h"
#include "components/model/identify/iir_filter.h"
#include "components/model/identify/processing_settings.h"
#include "components/model/identify/statistics.h"

namespace sinew::stance_fit {

inline Eigen::MatrixXd SmoothColumns(const Eigen::MatrixXd& x,
                                     const identify::ProcessingOptions& options, double rate_Hz) {
  Eigen::MatrixXd out(x.rows(), x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    out.col(c) = identify::Smooth(x.col(c), options.state_order, options.state_cutoff_Hz, rate_Hz);
  }
  return out;
}

inline Eigen::MatrixXd RateOfColumns(const Eigen::MatrixXd& x, double period_s) {
  Eigen::MatrixXd out(x.rows(), x.cols());
  for (Eigen::Index c = 0; c < x.cols(); ++c) {
    out.col(c) = identify::WideDifference(x.col(c), period_s);
  }
  return out;
}

// A joint that travels less than this many steps of its encoder stands: its direction is rounding.
inline constexpr double kLeastCounts = 50.0;

// Returns whether a joint travels by more than rounding.
inline bool Travels(const std::vector<types::Run>& runs) {
  double low = HUGE_VAL, high = -HUGE_VAL, step = 0.0;
  for (const types::Run& run : runs) {
    const Eigen::VectorXd& q = run.At(types::Signal::kPosition);
    low = std::min(low, q.minCoeff());
    high = std::max(high, q.maxCoeff());
    step = std::max(step, identify::Resolution(q));
  }
  return high - low > kLeastCounts * step;
}

// Without the turn about the vertical.
inline Eigen::Quaterniond WithoutHeading(const Eigen::Quaterniond& orientation) {
  const Eigen::Vector3d forward = orientation * Eigen::Vector3d::UnitX();
  const double heading = std::atan2(forward.y(), forward.x());
  return Eigen::AngleAxisd(-heading, Eigen::Vector3d::UnitZ()) * orientation;
}

}  // namespace sinew::stance_fit

#include "tools/tracking/tracking.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::tools {

using types::Signal;

TrackingScore ScoreTracking(const types::Run& run, double from_s) {
  const Eigen::VectorXd& time_s = run.time_s;
  const Eigen::VectorXd error_rad = run.At(Signal::kReferencePosition) - run.At(Signal::kPosition);
  TrackingScore score;
  score.has_current = run.Has(Signal::kMotorCurrent);
  score.has_torque = run.Has(Signal::kTorque) && run.Has(Signal::kVelocity);
  Eigen::Index first = 0;
  while (first < run.size() && time_s[first] - time_s[0] < from_s) ++first;
  if (run.size() - first < 2) {
    throw std::invalid_argument(run.name + ": fewer than two samples to score");
  }
  const auto power_W = [&run](Eigen::Index i) {
    return std::max(0.0, run.At(Signal::kTorque)[i] * run.At(Signal::kVelocity)[i]);
  };
  double error_sum = 0.0, torque_sum = 0.0, current_sum = 0.0;
  score.max_error_rad = std::abs(error_rad[first]);
  for (Eigen::Index i = first + 1; i < run.size(); ++i) {
    const double half_s = 0.5 * (time_s[i] - time_s[i - 1]);
    error_sum += half_s * (error_rad[i] * error_rad[i] + error_rad[i - 1] * error_rad[i - 1]);
    score.max_error_rad = std::max(score.max_error_rad, std::abs(error_rad[i]));
    if (score.has_current) {
      const Eigen::VectorXd& current_A = run.At(Signal::kMotorCurrent);
      current_sum += half_s * (current_A[i] * current_A[i] + current_A[i - 1] * current_A[i - 1]);
    }
    if (!score.has_torque) continue;
    const Eigen::VectorXd& torque_Nm = run.At(Signal::kTorque);
    torque_sum += half_s * (torque_Nm[i] * torque_Nm[i] + torque_Nm[i - 1] * torque_Nm[i - 1]);
    score.positive_work_J += half_s * (power_W(i) + power_W(i - 1));
  }
  score.duration_s = time_s[run.size() - 1] - time_s[first];
  score.mean_square_error_rad2 = error_sum / score.duration_s;
  score.rms_error_rad = std::sqrt(score.mean_square_error_rad2);
  score.rms_current_A = std::sqrt(current_sum / score.duration_s);
  score.rms_torque_Nm = std::sqrt(torque_sum / score.duration_s);
  return score;
}

}  // namespace sinew::tools

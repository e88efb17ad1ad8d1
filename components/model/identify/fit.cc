#include "components/model/identify/fit.h"

#include <cmath>

#include "components/model/identify/statistics.h"

namespace sinew::identify {

ModelError ErrorOf(const Design& design, const actuator::JointModel& model) {
  const Balance balance = MakeBalance(design, model);
  ModelError out;
  const double scale = balance.fits_scale ? balance.Scale(balance.nominal) : 1.0;
  out.residual = scale * (balance.target - balance.columns * balance.nominal);
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const Eigen::VectorXd left = out.residual(used);
  const Eigen::VectorXd drive = balance.drive_factor * balance.drive_torque(used);
  out.rms = Rms(left);
  out.percent = drive.squaredNorm() > 0.0 ? 100.0 * left.norm() / drive.norm() : 0.0;
  return out;
}

ModelError ErrorOf(const Design& design, const actuator::JointModel& model,
                   const actuator::JointModel& reference) {
  ModelError out = ErrorOf(design, model);
  const double ratio = actuator::DriveShare(reference, reference.balance) /
                       actuator::DriveShare(model, model.balance);
  out.residual *= ratio;
  out.rms *= std::abs(ratio);
  return out;
}

}  // namespace sinew::identify

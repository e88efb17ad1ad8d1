#include "components/model/identify/fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/model/identify/statistics.h"

namespace sinew::identify {

namespace {

Moments TotalMoments(const Design& design, const Balance& balance) {
  return MomentsOf(design.rows().UsedRows(), balance.columns, balance.target);
}

void Measure(const Design& design, const Eigen::VectorXd& drive, double factor,
             const Eigen::VectorXd& residual, double* rms, double* percent) {
  double squares = 0.0;
  double drive_squares = 0.0;
  double count = 0.0;
  for (const Eigen::Index i : design.rows().UsedRows()) {
    squares += residual[i] * residual[i];
    drive_squares += factor * factor * drive[i] * drive[i];
    count += 1.0;
  }
  *rms = count > 0.0 ? std::sqrt(squares / count) : 0.0;
  *percent = drive_squares > 0.0 ? 100.0 * std::sqrt(squares / drive_squares) : 0.0;
}

}  // namespace

ModelError ErrorOf(const Design& design, const actuator::JointModel& model) {
  const Balance balance = MakeBalance(design, model);
  ModelError out;
  const double scale = balance.fits_scale ? balance.Scale(balance.nominal) : 1.0;
  out.residual = scale * (balance.target - balance.columns * balance.nominal);
  Measure(design, balance.drive_torque, balance.drive_factor, out.residual, &out.rms, &out.percent);
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

FitResult FitModel(const Design& design, const actuator::JointModel& model,
                   const std::vector<Block>& blocks) {
  FitResult out;
  out.model = model;
  const Eigen::Index used = static_cast<Eigen::Index>(design.rows().UsedRows().size());
  const auto solve = [&](std::optional<bool> fits_scale) {
    out.balance = MakeBalance(design, model, fits_scale);
    if (used < 3 * out.balance.columns.cols() || blocks.size() < 2) {
      throw TooLittleData("recordings have " + std::to_string(used) +
                          " moving rows after filtering, too few to fit " +
                          std::to_string(out.balance.columns.cols()) + " parameters");
    }
    const Moments total = TotalMoments(design, out.balance);
    // The ridge shrinks toward the nominal values.
    out.coefficients =
        out.balance.nominal + Solve(total.G, total.m - total.G * out.balance.nominal);
    std::vector<Moments> parts;
    parts.reserve(blocks.size());
    for (const Block& block : blocks) {
      parts.push_back(MomentsOf(block, out.balance.columns, out.balance.target));
    }
    return BlockCovariance(parts, out.coefficients);
  };
  Eigen::MatrixXd covariance = solve(std::nullopt);
  if (out.balance.fits_scale) {
    // A scale known worse than by its tolerance (at least 5 %) is not known from this data.
    const double tolerance = std::max(0.05, out.balance.spread[0] / out.balance.nominal[0]);
    if (out.coefficients[0] <= 0.0 ||
        std::sqrt(covariance(0, 0)) > tolerance * std::abs(out.coefficients[0])) {
      covariance = solve(false);
    }
  }
  out.balance.Apply(out.coefficients, &out.model);

  // d physical / d coefficients.
  const Eigen::Index p = out.coefficients.size();
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(p, p);
  if (out.balance.fits_scale) {
    const double b0 = out.coefficients[0];
    jacobian(0, 0) = -1.0 / (b0 * b0);
    for (Eigen::Index i = 1; i < p; ++i) {
      jacobian(i, i) = 1.0 / b0;
      jacobian(i, 0) = -out.coefficients[i] / (b0 * b0);
    }
  }
  out.covariance = jacobian * covariance * jacobian.transpose();
  const double quantile = StudentQuantile(0.975, static_cast<double>(blocks.size() - 1));
  const auto half_width = [&](Eigen::Index i) {
    return quantile * std::sqrt(std::max(0.0, out.covariance(i, i)));
  };
  const auto value = [&](const ParameterRef& ref) -> actuator::ParameterValue& {
    return out.model.terms[static_cast<std::size_t>(ref.term)]
        .linear[static_cast<std::size_t>(ref.linear)];
  };
  const Eigen::Index first = out.balance.fits_scale ? 1 : 0;
  if (out.balance.fits_scale) value(out.balance.drive).half_width_95 = half_width(0);
  for (std::size_t i = 0; i < out.balance.parameters.size(); ++i) {
    value(out.balance.parameters[i]).half_width_95 =
        half_width(first + static_cast<Eigen::Index>(i));
  }
  const double scale = out.balance.fits_scale ? out.balance.Scale(out.coefficients) : 1.0;
  out.residual = scale * (out.balance.target - out.balance.columns * out.coefficients);
  Measure(design, out.balance.drive_torque, out.balance.Scale(out.coefficients), out.residual,
          &out.rms, &out.percent);
  return out;
}

}  // namespace sinew::identify

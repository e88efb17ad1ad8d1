#include "components/model/identify/balance.h"

#include <cmath>

#include "components/model/identify/statistics.h"

namespace sinew::identify {

namespace {

bool IsDrive(const actuator::Term& term) {
  return term.effect->info().role == effects::Role::kDrive;
}

// A declared shape that may be off by its tolerance (a rest angle) is not fitted: the column that
// its derivative is a multiple of takes it, and may be off by as much more.
void WidenByShapes(const Design& design, const actuator::JointModel& model, Balance* balance) {
  constexpr double kSameColumn = 0.99;  // squared cosine
  const double scale = balance->fits_scale ? balance->drive_factor : 1.0;
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  for (const actuator::Term& term : model.terms) {
    if (!model.Counts(term) || !term.declared || term.nonlinear.empty()) continue;
    for (std::size_t k = 0; k < term.nonlinear.size(); ++k) {
      const double spread =
          term.nonlinear[k].fixed ? 0.0 : actuator::PriorSpread(term.nonlinear[k]);
      if (!(spread > 0.0)) continue;
      const double at = term.nonlinear[k].value;
      const Eigen::VectorXd change =
          ShapedTorque(design, term, k, at + spread) - ShapedTorque(design, term, k, at);
      Eigen::Index nearest = -1;
      double best = kSameColumn, share = 0.0;
      for (Eigen::Index i = balance->scale_columns(); i < balance->columns.cols(); ++i) {
        const Eigen::VectorXd column = balance->columns.col(i)(used);
        const double both = column.dot(change), power = column.squaredNorm();
        const double same = both * both / std::max(1e-300, power * change.squaredNorm());
        if (!(same > best)) continue;
        best = same;
        nearest = i;
        share = both / power;
      }
      if (nearest >= 0 && balance->spread[nearest] > 0.0) {
        balance->spread[nearest] = std::hypot(balance->spread[nearest], share / scale);
      }
    }
  }
}

}  // namespace

Eigen::VectorXd Balance::Physical(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  if (!fits_scale) return coefficients;
  Eigen::VectorXd out = coefficients / coefficients[0];
  out[0] = 1.0 / coefficients[0];
  return out;
}

double Balance::Scale(const Eigen::Ref<const Eigen::VectorXd>& coefficients) const {
  return fits_scale ? 1.0 / coefficients[0] : drive_factor;
}

void Balance::Apply(const Eigen::Ref<const Eigen::VectorXd>& coefficients,
                    actuator::JointModel* model) const {
  const Eigen::VectorXd values = Physical(coefficients);
  for (Eigen::Index i = 0; i < values.size(); ++i) ParameterOf(i).In(model).value = values[i];
}

Eigen::VectorXd ShapedTorque(const Design& design, const actuator::Term& term, std::size_t k,
                             double value) {
  std::vector<double> psi = actuator::NonlinearValues(term);
  psi[k] = value;
  Eigen::VectorXd theta(static_cast<Eigen::Index>(term.linear.size()));
  for (std::size_t i = 0; i < term.linear.size(); ++i) {
    theta[static_cast<Eigen::Index>(i)] = term.linear[i].value;
  }
  return (design.Columns(*term.effect, psi) * theta)(design.rows().UsedRows());
}

Balance MakeBalance(const Design& design, const actuator::JointModel& model,
                    std::optional<bool> fits_scale) {
  Balance out;
  const Eigen::Index rows = design.rows().size();
  Eigen::VectorXd known = Eigen::VectorXd::Zero(rows);
  std::vector<Eigen::VectorXd> columns;
  std::vector<double> values;
  std::vector<double> tolerances;
  bool drive_fixed = false;
  double drive_tolerance = 0.0;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const actuator::Term& term = model.terms[t];
    if (!model.Counts(term)) continue;
    if (IsDrive(term)) {
      out.drive = {t, 0};
      out.drive_factor = term.linear.front().value;
      out.drive_torque = design.MeasuredDrive(*term.effect);
      drive_fixed = term.linear.front().fixed;
      drive_tolerance = actuator::RelativeSpread(term.linear.front());
      continue;
    }
    const Eigen::MatrixXd phi = design.Columns(*term.effect, actuator::NonlinearValues(term));
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      const actuator::ParameterValue& parameter = term.linear[i];
      const auto column = phi.col(static_cast<Eigen::Index>(i));
      if (parameter.fixed) {
        known += parameter.value * column;
        continue;
      }
      out.parameters.push_back({t, i});
      columns.emplace_back(-column);
      values.push_back(parameter.value);
      tolerances.push_back(actuator::PriorSpread(parameter));
    }
  }
  // Is there anything known that sets the scale? At least 1 % of the drive's size.
  double known_power = 0.0;
  double drive_power = 0.0;
  for (const Eigen::Index i : design.rows().UsedRows()) {
    known_power += known[i] * known[i];
    drive_power += out.drive_torque[i] * out.drive_torque[i] * out.drive_factor * out.drive_factor;
  }
  out.fits_scale =
      fits_scale.value_or(!drive_fixed && drive_power > 0.0 && known_power > 1e-4 * drive_power);

  const Eigen::Index first = out.scale_columns();
  const auto count = static_cast<Eigen::Index>(columns.size()) + first;
  out.columns.resize(rows, count);
  out.nominal.resize(count);
  out.spread.resize(count);
  const double scale = out.fits_scale ? out.drive_factor : 1.0;
  if (out.fits_scale) {
    out.target = out.drive_torque;
    out.columns.col(0) = -known;
    out.nominal[0] = 1.0 / out.drive_factor;
    out.spread[0] = drive_tolerance / out.drive_factor;
  } else {
    out.target = out.drive_factor * out.drive_torque + known;
  }
  for (Eigen::Index i = first; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i - first);
    out.columns.col(i) = columns[k];
    out.nominal[i] = values[k] / scale;
    out.spread[i] = tolerances[k] / scale;
  }
  WidenByShapes(design, model, &out);
  return out;
}

ModelError ErrorOf(const Design& design, const actuator::JointModel& model) {
  const Balance balance = MakeBalance(design, model);
  ModelError out;
  out.residual =
      balance.Unit(balance.nominal) * (balance.target - balance.columns * balance.nominal);
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

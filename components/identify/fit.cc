#include "components/identify/fit.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/identify/statistics.h"

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

struct Nonlinear {
  std::size_t term;
  std::size_t index;
};

std::vector<Nonlinear> FreeNonlinear(const actuator::JointModel& model) {
  std::vector<Nonlinear> out;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    if (model.terms[t].declared || !model.Counts(model.terms[t])) continue;
    for (std::size_t i = 0; i < model.terms[t].nonlinear.size(); ++i) {
      if (!model.terms[t].nonlinear[i].fixed) out.push_back({t, i});
    }
  }
  return out;
}

double& ValueOf(actuator::JointModel& model, const Nonlinear& at) {
  return model.terms[at.term].nonlinear[at.index].value;
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
  const auto solve = [&](bool keep_scale) {
    out.keep_scale = keep_scale;
    out.balance = MakeBalance(design, model, keep_scale);
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
    for (const Block& block : blocks) {
      parts.push_back(MomentsOf(block, out.balance.columns, out.balance.target));
    }
    return BlockCovariance(parts, out.coefficients);
  };
  Eigen::MatrixXd covariance = solve(false);
  if (out.balance.fits_scale) {
    // A scale known worse than by its tolerance (at least 5 %) is not known from this data.
    const double tolerance = std::max(0.05, out.balance.spread[0] / out.balance.nominal[0]);
    if (out.coefficients[0] <= 0.0 ||
        std::sqrt(covariance(0, 0)) > tolerance * std::abs(out.coefficients[0])) {
      covariance = solve(true);
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

FitResult RefineModel(const Design& design, const actuator::JointModel& model,
                      const std::vector<Block>& blocks) {
  const std::vector<Nonlinear> free = FreeNonlinear(model);
  FitResult best = FitModel(design, model, blocks);
  if (free.empty()) return best;
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const bool keep_scale = best.keep_scale;
  const auto cost = [&](const actuator::JointModel& candidate) {
    const Balance balance = MakeBalance(design, candidate, keep_scale);
    const Moments total = MomentsOf(used, balance.columns, balance.target);
    const Eigen::VectorXd b = Solve(total.G, total.m);
    return total.SquaredError(b);
  };
  actuator::JointModel at = best.model;
  double least = cost(at);
  double step = 0.3;
  for (int round = 0; round < 14 && step > 2e-3; ++round) {
    bool moved = false;
    for (const Nonlinear& which : free) {
      const effects::ParameterInfo& info =
          at.terms[which.term].effect->info().nonlinear[which.index];
      const double now = ValueOf(at, which);
      for (const double direction : {1.0, -1.0}) {
        actuator::JointModel trial = at;
        const double next = info.lower > 0.0
                                ? now * std::exp(direction * step)
                                : now + direction * step * 0.1 * (info.upper - info.lower);
        ValueOf(trial, which) = std::clamp(next, info.lower, info.upper);
        const double error = cost(trial);
        if (error < least) {
          least = error;
          at = std::move(trial);
          moved = true;
          break;
        }
      }
    }
    if (!moved) step *= 0.5;
  }
  best = FitModel(design, at, blocks);

  // Intervals of the nonlinear parameters, and the linear ones widened by them: the derivative of
  // the balance with respect to each joins the columns.
  const Eigen::Index p = best.coefficients.size();
  const auto extra = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd columns(design.rows().size(), p + extra);
  columns.leftCols(p) = best.balance.columns;
  const double scale = best.balance.fits_scale ? best.balance.Scale(best.coefficients) : 1.0;
  for (Eigen::Index k = 0; k < extra; ++k) {
    const Nonlinear& which = free[static_cast<std::size_t>(k)];
    const effects::ParameterInfo& info =
        best.model.terms[which.term].effect->info().nonlinear[which.index];
    const double now = best.model.terms[which.term].nonlinear[which.index].value;
    const double h = info.lower > 0.0 ? 1e-3 * now : 1e-4 * (info.upper - info.lower);
    const auto torque = [&](double psi) -> Eigen::VectorXd {
      actuator::Term term = best.model.terms[which.term];
      term.nonlinear[which.index].value = psi;
      Eigen::VectorXd theta(static_cast<Eigen::Index>(term.linear.size()));
      for (std::size_t i = 0; i < term.linear.size(); ++i) {
        theta[static_cast<Eigen::Index>(i)] = term.linear[i].value;
      }
      return design.Columns(*term.effect, actuator::NonlinearValues(term)) * theta;
    };
    columns.col(p + k) = -(torque(now + h) - torque(now - h)) / (2.0 * h) / scale;
  }
  Eigen::VectorXd b(p + extra);
  b << best.coefficients, Eigen::VectorXd::Zero(extra);
  std::vector<Moments> parts;
  for (const Block& block : blocks) parts.push_back(MomentsOf(block, columns, best.balance.target));
  const Eigen::MatrixXd covariance = BlockCovariance(parts, b);
  const double quantile = StudentQuantile(0.975, static_cast<double>(blocks.size() - 1));
  for (Eigen::Index k = 0; k < extra; ++k) {
    const Nonlinear& which = free[static_cast<std::size_t>(k)];
    best.model.terms[which.term].nonlinear[which.index].half_width_95 =
        quantile * std::sqrt(std::max(0.0, covariance(p + k, p + k)));
  }
  const Eigen::Index first = best.balance.fits_scale ? 1 : 0;
  for (std::size_t i = 0; i < best.balance.parameters.size(); ++i) {
    const ParameterRef& ref = best.balance.parameters[i];
    const Eigen::Index at_column = first + static_cast<Eigen::Index>(i);
    auto& parameter = best.model.terms[static_cast<std::size_t>(ref.term)]
                          .linear[static_cast<std::size_t>(ref.linear)];
    parameter.half_width_95 =
        std::max(parameter.half_width_95.value_or(0.0),
                 quantile * scale * std::sqrt(std::max(0.0, covariance(at_column, at_column))));
  }
  return best;
}

actuator::JointModel WithinPhysicalRange(const Design& design, const actuator::JointModel& model,
                                         const std::vector<Block>& blocks) {
  actuator::JointModel at = model;
  for (bool held = true; held;) {
    held = false;
    for (actuator::Term& term : at.terms) {
      const effects::EffectInfo& info = term.effect->info();
      if (info.role == effects::Role::kDrive || !term.declared || !at.Counts(term)) continue;
      for (std::size_t i = 0; i < term.linear.size(); ++i) {
        actuator::ParameterValue& value = term.linear[i];
        // Values relative to the drive have their range for another scale.
        if (value.fixed || info.linear[i].relative_to_drive) continue;
        const double bound = std::clamp(value.value, info.linear[i].lower, info.linear[i].upper);
        if (bound == value.value) continue;
        value.value = bound;
        value.fixed = held = true;
      }
    }
    if (held) at = FitModel(design, at, blocks).model;
  }
  for (std::size_t t = 0; t < at.terms.size(); ++t) {
    for (std::size_t i = 0; i < at.terms[t].linear.size(); ++i) {
      at.terms[t].linear[i].fixed = model.terms[t].linear[i].fixed;
      at.terms[t].linear[i].half_width_95 = model.terms[t].linear[i].half_width_95;
    }
  }
  return at;
}

actuator::JointModel FitWithinTolerances(const Design& design, const actuator::JointModel& model) {
  const Balance balance = MakeBalance(design, model);
  const Moments total = TotalMoments(design, balance);
  Eigen::VectorXd b = balance.nominal;
  // Coordinate descent on a convex quadratic in a box.
  for (int round = 0; round < 5000; ++round) {
    double moved = 0.0;
    for (Eigen::Index i = 0; i < b.size(); ++i) {
      if (!(total.G(i, i) > 0.0)) continue;
      double next = b[i] + (total.m[i] - total.G.row(i).dot(b)) / total.G(i, i);
      if (balance.spread[i] > 0.0) {
        next = std::clamp(next, balance.nominal[i] - balance.spread[i],
                          balance.nominal[i] + balance.spread[i]);
      }
      moved = std::max(moved, std::abs(next - b[i]) * std::sqrt(total.G(i, i)));
      b[i] = next;
    }
    if (moved < 1e-10 * std::sqrt(total.yy)) break;
  }
  actuator::JointModel out = model;
  balance.Apply(b, &out);
  return out;
}

}  // namespace sinew::identify

#include <algorithm>
#include <cmath>

#include "components/model/trace/reported.h"

namespace sinew::trace {

namespace {

// Part of a candidate's power that the declared terms must carry for it to be absorbed.
constexpr double kInSpan = 0.98;
// Tolerances beyond which the declared value itself is a cause.
constexpr double kStatedWrongly = 3.0;

struct Declared {
  identify::ParameterRef ref;
  Eigen::Index column;  // of the balance
  double shift = 0.0;
  double unit = 0.0;  // tolerance and standard error together
};

std::vector<Declared> DeclaredParameters(const actuator::JointModel& nominal,
                                         const identify::FitResult& fit) {
  std::vector<Declared> declared;
  for (Eigen::Index column = 0; column < fit.balance.columns.cols(); ++column) {
    const identify::ParameterRef& ref = fit.balance.ParameterOf(column);
    if (ref.term >= nominal.terms.size()) continue;
    const actuator::ParameterValue &before = ref.In(nominal), &after = ref.In(fit.model);
    const double tolerance = actuator::PriorSpread(before);
    if (!(tolerance > 0.0)) continue;
    const double error = after.half_width_95.value_or(0.0) / 2.0;
    declared.push_back({ref, column, after.value - before.value,
                        std::sqrt(tolerance * tolerance + error * error)});
  }
  return declared;
}

struct ShiftDirection {
  const Candidate* candidate;
  std::vector<double> per_theta;  // in declared units
};

// Directions in which each candidate would shift the parameters: its regressor in terms of phi,
// theirs.
std::vector<ShiftDirection> DirectionsOf(const std::vector<Candidate>& candidates,
                                         const std::vector<Eigen::Index>& used,
                                         const Eigen::MatrixXd& phi,
                                         const identify::Balance& balance,
                                         const std::vector<Declared>& declared) {
  const Eigen::Index first = balance.scale_columns();
  const Eigen::MatrixXd gram = phi.transpose() * phi;
  const Eigen::VectorXd drive = balance.drive_torque(used);
  std::vector<ShiftDirection> directions;
  for (const Candidate& candidate : candidates) {
    if (candidate.stated || candidate.grid.size() != 1 ||
        candidate.grid.front().columns.cols() != 1)
      continue;
    const Eigen::VectorXd z = candidate.grid.front().columns(used, 0);
    const double power = z.squaredNorm();
    if (!(power > 0.0)) continue;
    ShiftDirection direction{&candidate, std::vector<double>(declared.size(), 0.0)};
    const double with_drive = z.dot(drive) / std::sqrt(power * drive.squaredNorm());
    if (with_drive > 0.9999) {  // scales the drive: the factor alone takes it
      for (std::size_t j = 0; j < declared.size(); ++j) {
        if (balance.fits_scale && declared[j].column == 0) {
          direction.per_theta[j] = std::sqrt(power / drive.squaredNorm()) / declared[j].unit;
        }
      }
    } else {
      const Eigen::VectorXd a = identify::Solve(gram, phi.transpose() * z);
      if ((z - phi * a).squaredNorm() > (1.0 - kInSpan) * power) continue;
      for (std::size_t j = 0; j < declared.size(); ++j) {
        if (declared[j].column >= first) {
          direction.per_theta[j] = a[declared[j].column - first] / declared[j].unit;
        }
      }
    }
    directions.push_back(std::move(direction));
  }
  return directions;
}

}  // namespace

std::vector<ParameterShift> FindShifts(const identify::Design& design,
                                       const actuator::JointModel& nominal,
                                       const identify::FitResult& fit,
                                       const std::vector<Candidate>& candidates) {
  std::vector<ParameterShift> out;
  const identify::Balance& balance = fit.balance;
  const Eigen::Index first = balance.scale_columns();
  std::vector<Declared> declared = DeclaredParameters(nominal, fit);
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  const Eigen::Index count = balance.columns.cols() - first;
  const Eigen::MatrixXd phi = -balance.columns.rightCols(count)(used, Eigen::all);
  const Eigen::MatrixXd gram = phi.transpose() * phi;
  // Parameters that are held but stated with a tolerance (a rest angle): what they may be off by
  // shifts the fitted ones, and that is no prior penalty either.
  for (const actuator::Term& term : nominal.terms) {
    for (std::size_t k = 0; k < term.nonlinear.size(); ++k) {
      const double off = actuator::PriorSpread(term.nonlinear[k]);
      if (!term.nonlinear[k].fixed || !(off > 0.0)) continue;
      const double value = term.nonlinear[k].value;
      const Eigen::VectorXd z = 0.5 * (identify::ShapedTorque(design, term, k, value + off) -
                                       identify::ShapedTorque(design, term, k, value - off));
      const Eigen::VectorXd a = identify::Solve(gram, phi.transpose() * z);
      for (Declared& item : declared) {
        if (item.column >= first) item.unit = std::hypot(item.unit, a[item.column - first]);
      }
    }
  }
  const std::vector<ShiftDirection> directions =
      DirectionsOf(candidates, used, phi, balance, declared);
  for (const Declared& item : declared) {
    const double sigma = item.shift / item.unit;
    if (std::abs(sigma) < 1.0) continue;
    const actuator::ParameterValue &before = item.ref.In(nominal), &after = item.ref.In(fit.model);
    const effects::EffectInfo& info = nominal.terms[item.ref.term].effect->info();
    ParameterShift shift = {.effect = info.name,
                            .parameter = info.linear[item.ref.linear].name,
                            .nominal = before.value,
                            .refit = after.value,
                            .tolerance = actuator::PriorSpread(before),
                            .half_width_95 = after.half_width_95.value_or(0.0),
                            .sigma = sigma,
                            .causes = {}};
    const auto j = static_cast<std::size_t>(&item - declared.data());
    for (const ShiftDirection& direction : directions) {
      // Shares the direction when this parameter carries a good part of what it would shift.
      double largest = 0.0;
      for (const double value : direction.per_theta) largest = std::max(largest, std::abs(value));
      if (largest > 0.0 && std::abs(direction.per_theta[j]) > 0.05 * largest) {
        shift.causes.push_back(direction.candidate->name());
      }
    }
    const bool listed = std::count(shift.causes.begin(), shift.causes.end(), info.name) > 0;
    if (std::abs(sigma) > kStatedWrongly && !listed) shift.causes.push_back(info.name);
    out.push_back(std::move(shift));
  }
  return out;
}

}  // namespace sinew::trace

#include "components/model/trace/whitened_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "components/model/identify/statistics.h"
#include "components/model/trace/candidates.h"
#include "components/model/trace/machine_size.h"

namespace sinew::trace {

namespace {

using identify::Balance;
using identify::Rms;

// Precision that holds a coefficient, as a multiple of what its rows say.
constexpr double kHeld = 1e12;

// Whitened rows with the priors as further rows.
struct Regression {
  Eigen::MatrixXd X;
  Eigen::VectorXd y;
  Prior prior;

  Eigen::MatrixXd Hessian() const {
    Eigen::MatrixXd out = X.transpose() * X;
    out.diagonal() += prior.precision;
    for (Eigen::Index i = 0; i < out.rows(); ++i) out(i, i) += 1e-9 * out(i, i) + 1e-300;
    return out;
  }
  Eigen::VectorXd Solve() const {
    return prior.mean + Hessian().ldlt().solve(X.transpose() * (y - X * prior.mean));
  }
  void Hold(Eigen::Index i, double value) {
    prior.mean[i] = value;
    prior.precision[i] = kHeld * std::max(1e-300, X.col(i).squaredNorm());
  }
  double Misfit(const Eigen::VectorXd& b) const {
    return (y - X * b).squaredNorm() +
           (prior.precision.array() * (b - prior.mean).array().square()).sum();
  }
};

Regression MakeRegression(const identify::Design& design, const Likelihood& likelihood,
                          const actuator::JointModel& model, const Balance& balance) {
  const UsedRows& used = likelihood.used;
  const Nuisances nuisances = MakeNuisances(design, likelihood, model);
  Eigen::MatrixXd columns(used.size(), balance.columns.cols() + nuisances.columns.cols());
  columns << used.Of(balance.columns), nuisances.columns;
  Regression out;
  out.X = Whiten(likelihood, columns);
  out.y = Whiten(likelihood, balance.target(used.rows));
  out.prior = PriorOf(balance, model, used, nuisances);
  return out;
}

// Coefficients within their physical range (friction does not drive): one that would leave it is
// held at its bound.
Eigen::VectorXd SolveWithinRange(const identify::Design& design, const Balance& balance,
                                 const actuator::JointModel& model, Regression* regression) {
  const Eigen::Index first = balance.scale_columns(), p = balance.columns.cols();
  Eigen::VectorXd b = regression->Solve();
  std::vector<char> is_held(static_cast<std::size_t>(p), 0);
  for (bool held = true; held;) {
    held = false;
    const double scale = balance.Unit(b.head(p));
    for (Eigen::Index i = first; i < p; ++i) {
      const std::size_t linear = balance.ParameterOf(i).linear;
      const actuator::Term& term = model.terms[balance.ParameterOf(i).term];
      const effects::ParameterInfo& info = term.effect->info().linear[linear];
      char& mark = is_held[static_cast<std::size_t>(i)];
      if (mark != 0 || info.relative_to_drive) continue;
      const Range range = term.declared ? RangeOnAnyMachine(info)
                                        : RangeOfAddition(design, model, *term.effect,
                                                          actuator::NonlinearValues(term), linear);
      const double bound = std::clamp(scale * b[i], range.lower, range.upper) / scale;
      if (bound == b[i]) continue;
      regression->Hold(i, bound);
      mark = 1;
      held = true;
    }
    if (held) b = regression->Solve();
  }
  for (Eigen::Index i = first; i < p; ++i) {
    if (is_held[static_cast<std::size_t>(i)] != 0) b[i] = regression->prior.mean[i];
  }
  return b;
}

// Cluster-robust covariance of coefficients with priors: H^-1 (sum s_b s_b' + P) H^-1 with the
// factor of block_regression.h.
Eigen::MatrixXd Covariance(const Regression& regression, const Eigen::VectorXd& b,
                           const std::vector<identify::Block>& blocks) {
  const Eigen::MatrixXd inverse =
      regression.Hessian().ldlt().solve(Eigen::MatrixXd::Identity(b.size(), b.size()));
  const Eigen::VectorXd e = regression.y - regression.X * b;
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(b.size(), b.size());
  for (const identify::Block& block : blocks) {
    const auto rows = static_cast<Eigen::Index>(block.size());
    const Eigen::VectorXd score =
        regression.X.middleRows(block.front(), rows).transpose() * e.segment(block.front(), rows);
    meat += score * score.transpose();
  }
  const auto count = static_cast<double>(blocks.size());
  const auto n = static_cast<double>(e.size());
  const auto p = static_cast<double>(b.size());
  meat *= count / std::max(1.0, count - 1.0) * (n - 1.0) / std::max(1.0, n - p);
  meat.diagonal() += regression.prior.precision;
  return inverse * meat * inverse;
}

struct Free {
  std::size_t term, index;
  double lower, upper;  // of the search
};

// Twice as far as the grid: beyond, a column may vanish, and its coefficient means nothing.
Free MakeFree(const identify::Design& design, const actuator::JointModel& model, std::size_t term,
              std::size_t index) {
  const effects::EffectInfo& effect = model.terms[term].effect->info();
  const effects::ParameterInfo& info = effect.nonlinear[index];
  if (!(info.lower > 0.0)) return {term, index, info.lower, info.upper};
  double least = info.upper, largest = info.lower;
  for (const std::vector<double>& psi : GridFor(design, model.constants, effect)) {
    least = std::min(least, psi[index]);
    largest = std::max(largest, psi[index]);
  }
  return {term, index, std::max(info.lower, 0.5 * least), std::min(info.upper, 2.0 * largest)};
}

std::vector<Free> FreeShapes(const identify::Design& design, const actuator::JointModel& model) {
  std::vector<Free> out;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    if (model.terms[t].declared || !model.Counts(model.terms[t])) continue;
    for (std::size_t i = 0; i < model.terms[t].nonlinear.size(); ++i) {
      if (!model.terms[t].nonlinear[i].fixed) out.push_back(MakeFree(design, model, t, i));
    }
  }
  return out;
}

}  // namespace

Eigen::MatrixXd Whiten(const Likelihood& likelihood,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  return likelihood.noise.Whiten(columns, likelihood.used.stretches, likelihood.weight);
}

Eigen::VectorXd WhitenTransposed(const Likelihood& likelihood,
                                 const Eigen::Ref<const Eigen::VectorXd>& whitened) {
  Eigen::VectorXd out = likelihood.noise.Transpose(whitened, likelihood.used.stretches);
  if (likelihood.weight.size() == 0) return out;
  return likelihood.weight.cwiseProduct(out);
}

void SetNoise(const Eigen::Ref<const Eigen::VectorXd>& residual, Eigen::Index window,
              int longest_order, Likelihood* likelihood) {
  const Eigen::Index n = residual.size();
  Eigen::VectorXd sum(n + 1);
  sum[0] = 0.0;
  for (Eigen::Index i = 0; i < n; ++i) sum[i + 1] = sum[i] + residual[i] * residual[i];
  Eigen::VectorXd scale(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Index from = std::max<Eigen::Index>(0, i - window);
    const Eigen::Index to = std::min<Eigen::Index>(n, i + window + 1);
    scale[i] = std::sqrt((sum[to] - sum[from]) / static_cast<double>(to - from));
  }
  const double middle =
      n > 0 ? identify::Quantile(std::vector<double>(scale.begin(), scale.end()), 0.5) : 0.0;
  if (middle > 0.0) {
    // The local scale has a lower bound: half of the typical one.
    likelihood->weight = (scale.array() / middle).max(0.5).inverse();
    const Eigen::VectorXd even = likelihood->weight.cwiseProduct(residual);
    likelihood->noise = NoiseModel(even, likelihood->used.stretches, longest_order);
  } else {
    likelihood->weight = Eigen::VectorXd();
    likelihood->noise = NoiseModel(residual, likelihood->used.stretches, longest_order);
  }
}

void SetNoiseByRecording(const identify::Design& design,
                         const Eigen::Ref<const Eigen::VectorXd>& residual,
                         Likelihood* likelihood) {
  constexpr int kMemory = 6;  // rows
  const UsedRows& used = likelihood->used;
  std::map<std::size_t, std::vector<double>> by_run;
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    by_run[design.rows().RunOf(used.rows[static_cast<std::size_t>(i)])].push_back(residual[i]);
  }
  std::map<std::size_t, double> scale;
  for (auto& [run, values] : by_run) scale[run] = identify::RobustDeviation(std::move(values));
  likelihood->weight.resize(residual.size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const double own = scale[design.rows().RunOf(used.rows[static_cast<std::size_t>(i)])];
    likelihood->weight[i] = own > 0.0 ? 1.0 / own : 1.0;
  }
  const Eigen::VectorXd even = likelihood->weight.cwiseProduct(residual);
  likelihood->noise = NoiseModel(even, used.stretches, design.held() ? 0 : kMemory);
}

Likelihood Unweighted(Likelihood likelihood, const Eigen::Ref<const Eigen::VectorXd>& residual) {
  double of_rows = 0.0, of_blocks = 0.0;
  for (const identify::Block& block : likelihood.used.blocks) {
    const auto e = residual.segment(block.front(), static_cast<Eigen::Index>(block.size()));
    of_rows += e.squaredNorm();
    of_blocks += e.sum() * e.sum();
  }
  const double louder = of_rows > 0.0 ? std::sqrt(std::max(1.0, of_blocks / of_rows)) : 1.0;
  likelihood.weight = Eigen::VectorXd();
  likelihood.noise = NoiseModel(louder * residual, likelihood.used.stretches, 0);
  return likelihood;
}

Prior PriorOf(const Balance& balance, const actuator::JointModel& model, const UsedRows& used,
              const Nuisances& nuisances) {
  const Eigen::Index p = balance.columns.cols(), extra = nuisances.columns.cols();
  Prior out;
  out.mean = Eigen::VectorXd::Zero(p + extra);
  out.precision = Eigen::VectorXd::Zero(p + extra);
  const auto precision = [](double spread) { return spread > 0.0 ? 1.0 / (spread * spread) : 0.0; };
  const double drive_tolerance = actuator::RelativeSpread(balance.drive.In(model));
  const double target_rms = Rms(balance.target(used.rows));
  if (balance.fits_scale) {
    out.mean[0] = balance.nominal[0];
    out.precision[0] = precision(balance.spread[0]);
  }
  for (Eigen::Index i = balance.scale_columns(); i < p; ++i) {
    if (model.terms[balance.ParameterOf(i).term].declared) {
      out.mean[i] = balance.nominal[i];
      // Coefficients are divided by the drive's factor and share its tolerance.
      if (balance.spread[i] > 0.0) {
        out.precision[i] =
            precision(std::hypot(balance.spread[i], balance.nominal[i] * drive_tolerance));
      }
    } else {
      const double rms = Rms(balance.columns.col(i)(used.rows));
      out.precision[i] = rms > 0.0 ? precision(kPlausibleShare * target_rms / rms) : 0.0;
    }
  }
  out.mean.tail(extra) = nuisances.mean;
  for (Eigen::Index k = 0; k < extra; ++k) out.precision[p + k] = precision(nuisances.spread[k]);
  return out;
}

Eigen::VectorXd LeftOver(const identify::FitResult& fit, const UsedRows& used) {
  return (fit.balance.target - fit.balance.columns * fit.coefficients)(used.rows);
}

identify::FitResult FitWhitened(const identify::Design& design, const Likelihood& likelihood,
                                const actuator::JointModel& model) {
  const UsedRows& used = likelihood.used;
  identify::FitResult out;
  out.model = model;
  out.balance = identify::MakeBalance(design, model, likelihood.fits_scale);
  const Eigen::Index p = out.balance.columns.cols();
  if (used.size() < 3 * p || used.blocks.size() < 2) {
    throw identify::TooLittleData("recordings have " + std::to_string(used.size()) +
                                  " moving rows, too few to fit " + std::to_string(p) +
                                  " parameters");
  }
  Regression regression = MakeRegression(design, likelihood, model, out.balance);
  const Eigen::VectorXd b = SolveWithinRange(design, out.balance, model, &regression);
  const Eigen::MatrixXd covariance = Covariance(regression, b, used.blocks).topLeftCorner(p, p);
  out.coefficients = b.head(p);
  // d physical / d coefficients.
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Identity(p, p);
  if (out.balance.fits_scale) {
    const double b0 = b[0];
    jacobian(0, 0) = -1.0 / (b0 * b0);
    for (Eigen::Index i = 1; i < p; ++i) {
      jacobian(i, i) = 1.0 / b0;
      jacobian(i, 0) = -b[i] / (b0 * b0);
    }
  }
  out.covariance = jacobian * covariance * jacobian.transpose();
  out.balance.Apply(out.coefficients, &out.model);
  const double quantile =
      identify::StudentQuantile(0.975, static_cast<double>(used.blocks.size() - 1));
  for (Eigen::Index i = 0; i < p; ++i) {
    if (out.balance.columns.col(i).isZero(0.0)) continue;  // nothing is known of it
    out.balance.ParameterOf(i).In(&out.model).half_width_95 =
        quantile * std::sqrt(std::max(0.0, out.covariance(i, i)));
  }
  return out;
}

identify::FitResult RefineWhitened(const identify::Design& design, const Likelihood& likelihood,
                                   const actuator::JointModel& model) {
  actuator::JointModel at = model;
  const std::vector<Free> free = FreeShapes(design, model);
  const auto misfit = [&](const actuator::JointModel& trial) {
    const Balance balance = identify::MakeBalance(design, trial, likelihood.fits_scale);
    const Regression regression = MakeRegression(design, likelihood, trial, balance);
    return regression.Misfit(regression.Solve());
  };
  double step = 0.3;
  double least = free.empty() ? 0.0 : misfit(at);
  for (int round = 0; !free.empty() && round < 8 && step > 0.02; ++round) {
    bool moved = false;
    for (const Free& which : free) {
      const effects::ParameterInfo& info =
          at.terms[which.term].effect->info().nonlinear[which.index];
      for (const double direction : {1.0, -1.0}) {
        actuator::JointModel trial = at;
        double& value = trial.terms[which.term].nonlinear[which.index].value;
        value = info.lower > 0.0 ? value * std::exp(direction * step)
                                 : value + direction * step * 0.1 * (info.upper - info.lower);
        value = std::clamp(value, which.lower, which.upper);
        const double error = misfit(trial);
        if (!(error < least)) continue;
        least = error;
        at = std::move(trial);
        moved = true;
        break;
      }
    }
    if (!moved) step *= 0.5;
  }
  return FitWhitened(design, likelihood, at);
}

std::vector<std::string> ImplausibleNuisances(const identify::Design& design,
                                              const Likelihood& likelihood,
                                              const actuator::JointModel& model) {
  const Balance balance = identify::MakeBalance(design, model, likelihood.fits_scale);
  const Nuisances nuisances = MakeNuisances(design, likelihood, model);
  Regression regression = MakeRegression(design, likelihood, model, balance);
  const Eigen::Index first = balance.columns.cols();
  std::vector<std::string> out = likelihood.no_nuisance;
  // The worst first: others may stand for it. What leaves is held at nothing.
  for (;;) {
    const Eigen::VectorXd b = regression.Solve();
    double worst = 1.0;
    std::size_t leaves = nuisances.names.size();
    for (std::size_t k = 0; k < nuisances.names.size(); ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const double times = std::abs(b[first + i]) / (nuisances.most[k] * nuisances.spread[i]);
      if (!(times > worst)) continue;
      worst = times;
      leaves = k;
    }
    if (leaves == nuisances.names.size()) return out;
    out.push_back(nuisances.names[leaves]);
    regression.Hold(first + static_cast<Eigen::Index>(leaves), 0.0);
  }
}

}  // namespace sinew::trace

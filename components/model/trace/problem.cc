#include "components/model/trace/problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "components/model/identify/statistics.h"

namespace sinew::trace {

namespace {

// Sizes behind two low-passes that differ by less are one, share of the smaller. Provisional, rigs
// 100300 to 100321 (rig_bank): delays that are there 0.00 to 0.25; of other names with more than
// explained_share 0.35 and more, but for one of 0.14 (docs/decisions/0020).
constexpr double kSteadyWithin = 1.0 / 3.0;

// Periods of the angles' low-pass over which the noise's scale is taken.
constexpr double kScalePeriods = 3.0;
// Standard deviations: one of a thousand million normal rows is further out.
constexpr double kOutlier = 6.0;
// Without a stated tolerance the known torques alone set the drive's scale: to this accuracy.
constexpr double kScaleKnown = 0.05;

constexpr std::uint64_t kEventSeed = 1;

// Rows per period of the lowest filter.
double RowsPerPeriod(const identify::Design& design) {
  const double cutoff_Hz =
      std::min(design.options().state_cutoff_Hz, design.options().parallel_cutoff_Hz);
  return design.rows_per_s() / std::max(1e-9, cutoff_Hz);
}

// Holds have no neighbours: one scale for all.
Eigen::Index ScaleWindow(const identify::Design& design) {
  if (design.held()) return design.rows().size();
  return static_cast<Eigen::Index>(std::ceil(kScalePeriods * RowsPerPeriod(design)));
}

// Without what began at an instant: it would count as loud noise there, and then be no more than
// that noise.
Eigen::VectorXd WithoutEvent(const identify::Design& design, const Likelihood& likelihood,
                             Eigen::VectorXd residual) {
  if (!likelihood.event) return residual;
  const Eigen::MatrixXd part =
      likelihood.used.Of(design.Columns(*likelihood.event->effect, likelihood.event->Psi()));
  return identify::LeftBy(part, residual);
}

// Leaves out the rows that lie far outside of what the richest model leaves, and learns the noise
// of the others.
void LeaveOutliers(const identify::Design& design, const Eigen::VectorXd& rest,
                   Likelihood* likelihood) {
  const Eigen::VectorXd e = Whiten(*likelihood, rest);
  const double limit = kOutlier * identify::RobustDeviation({e.begin(), e.end()});
  std::vector<Eigen::Index> kept, rows;
  for (Eigen::Index i = 0; i < e.size(); ++i) {
    if (std::abs(e[i]) > limit) continue;
    kept.push_back(i);
    rows.push_back(likelihood->used.rows[static_cast<std::size_t>(i)]);
  }
  likelihood->used = MakeUsedRows(design, std::move(rows), kFewestRowsPerBlock);
  const Eigen::VectorXd clean = rest(kept);
  SetNoiseByRecording(design, clean, likelihood);
}

}  // namespace

void LearnNoise(const identify::Design& design, const Eigen::Ref<const Eigen::VectorXd>& residual,
                effects::Balance balance, Likelihood* likelihood) {
  if (balance == effects::Balance::kMotion) {
    SetNoiseByRecording(design, residual, likelihood);
  } else {
    SetNoise(residual, ScaleWindow(design), LongestOrder(design), likelihood);
  }
}

int LongestOrder(double rows_per_period) {
  return static_cast<int>(std::clamp(std::ceil(2.0 * rows_per_period), 6.0, 40.0));
}
int LongestOrder(const identify::Design& design) { return LongestOrder(RowsPerPeriod(design)); }

Eigen::VectorXd Richest(const Problem& problem) {
  Columns all;
  for (const Hypothesis& h : problem.hypotheses()) {
    if (h.asked != Asked::kRival) all.insert(all.end(), h.columns.begin(), h.columns.end());
  }
  const Eigen::VectorXd c = problem.evidence.Solve(all);
  return problem.bank.target - problem.bank.declared * problem.evidence.Declared(all, c) -
         problem.bank.columns(Eigen::all, all) * c;
}

Eigen::VectorXd Problem::Left(const EffectSet& set) const {
  Eigen::VectorXd e = y - X * evidence.Declared(set.columns, set.c);
  for (std::size_t k = 0; k < set.columns.size(); ++k) {
    e -= Z.col(set.columns[k]) * set.c[static_cast<Eigen::Index>(k)];
  }
  return e;
}

Eigen::VectorXd Problem::LeftOut(const EffectSet& set,
                                 const std::vector<identify::Block>& blocks) const {
  const auto members = static_cast<Eigen::Index>(set.columns.size());
  Eigen::MatrixXd W(y.size(), X.cols() + members);
  W << X, Z(Eigen::all, set.columns);
  Eigen::VectorXd precision(W.cols());
  precision << bank.prior.precision, evidence.precision()(set.columns);
  // Deviations from the priors' means: those of the set's members are zero.
  const Eigen::VectorXd target = y - X * bank.prior.mean;
  const Eigen::MatrixXd gram = W.transpose() * W;
  const Eigen::VectorXd moment = W.transpose() * target;
  // A coefficient that only that block excites stays at its prior's mean.
  precision += kRidge * gram.diagonal();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(y.size());
  for (const identify::Block& block : blocks) {
    const Eigen::MatrixXd mine = W(block, Eigen::all);
    const Eigen::VectorXd own = target(block);
    Eigen::MatrixXd A = gram - mine.transpose() * mine;
    A.diagonal() += precision;
    out(block) = own - mine * A.ldlt().solve(moment - mine.transpose() * own);
  }
  return out;
}

Eigen::VectorXd Problem::Part(const EffectSet& set) const {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(bank.target.size());
  for (std::size_t k = 0; k < set.columns.size(); ++k) {
    out += bank.columns.col(set.columns[k]) * set.c[static_cast<Eigen::Index>(k)];
  }
  return out;
}

double Problem::VarianceShare(const EffectSet& set) const {
  if (set.empty() || !(variance > 0.0)) return 0.0;
  return 1.0 - LeftPlain(bank.target - Part(set)).squaredNorm() / variance;
}

Eigen::VectorXd Problem::LeftPlain(const Eigen::VectorXd& rest) const {
  if (plain_precision.size() == 0) return identify::LeftBy(bank.declared, rest);
  Eigen::MatrixXd A = bank.declared.transpose() * bank.declared;
  A.diagonal() += plain_precision;
  A.diagonal() *= 1.0 + kRidge;
  return rest - bank.declared * A.ldlt().solve(bank.declared.transpose() * rest);
}

Problem MakeProblem(const identify::Design& design, const Likelihood& likelihood,
                    const actuator::JointModel& declared, const identify::FitResult& fit) {
  Bank bank = MakeBank(design, likelihood, declared, fit.balance);
  Eigen::MatrixXd X = Whiten(likelihood, bank.declared);
  Eigen::VectorXd y = Whiten(likelihood, bank.target);
  const Evidence alone(X, bank.prior, Eigen::MatrixXd(X.rows(), 0), Eigen::VectorXd(), y);
  AddOrders(design, likelihood, declared, fit.balance, y - X * alone.Declared({}, {}), &bank);
  Eigen::MatrixXd Z = Whiten(likelihood, bank.columns);
  const Eigen::VectorXd precision =
      (bank.spread.array() > 0.0).select(bank.spread.array().square().inverse(), 1e300);
  Evidence evidence(X, bank.prior, Z, precision, y);
  const double scale = fit.balance.Unit(fit.coefficients);
  const double variance = identify::LeftBy(bank.declared, bank.target).squaredNorm();
  return {std::move(bank), std::move(X),        std::move(Z), std::move(y),
          scale,           std::move(evidence), variance};
}

namespace {

// A drive that acts late shows by its rate, measured or predicted; noise makes either too small
// (errors in variables). The better one leaves less.
bool PredictedRateGainsMore(identify::Design* design, const Likelihood& likelihood,
                            const actuator::JointModel& declared, const identify::FitResult& fit) {
  if (declared.balance != effects::Balance::kMotion || design->held()) return false;
  const auto delay = effects::MakeEffect("transport_delay", declared.constants);
  const std::vector<Eigen::Index>& rows = likelihood.used.rows;
  const Eigen::MatrixXd known = likelihood.used.Of(fit.balance.columns);
  const Eigen::VectorXd target = fit.balance.target(rows);
  const auto gain = [&](bool predicted) {
    design->UsePredictedRate(predicted);
    design->PredictDrive(fit.model);
    const Eigen::VectorXd column =
        likelihood.used.Of(design->Columns(*delay, std::vector<double>{0.0})).col(0);
    const Prior flat{Eigen::VectorXd::Zero(known.cols()), Eigen::VectorXd::Zero(known.cols())};
    return Evidence(known, flat, column, Eigen::VectorXd::Zero(1), target).Gain({0});
  };
  return gain(true) > gain(false);
}

}  // namespace

LikelihoodFit EstimateLikelihood(identify::Design* design, const actuator::JointModel& declared,
                                 const InForce& in_force) {
  LikelihoodFit out;
  Likelihood& likelihood = out.likelihood;
  likelihood.in_force = in_force;
  likelihood.used = MakeUsedRows(*design, kFewestRowsPerBlock);
  const Eigen::VectorXd nominal =
      identify::ErrorOf(*design, declared).residual(likelihood.used.rows);
  likelihood.noise = NoiseModel(nominal, likelihood.used.stretches, 0);
  out.fit = FitWhitened(*design, likelihood, declared);
  if (out.fit.balance.fits_scale) {
    const double error = std::sqrt(std::max(0.0, out.fit.covariance(0, 0))) /
                         std::abs(out.fit.balance.Scale(out.fit.coefficients));
    if (out.fit.coefficients[0] <= 0.0 ||
        (out.fit.balance.spread[0] == 0.0 && error > kScaleKnown)) {
      likelihood.fits_scale = false;
      out.fit = FitWhitened(*design, likelihood, declared);
    }
  }
  likelihood.predicted_rate = PredictedRateGainsMore(design, likelihood, declared, out.fit);
  design->UsePredictedRate(likelihood.predicted_rate);
  design->PredictDrive(out.fit.model);

  // A timed effect must be known before the noise is: it would count as loud noise.
  if (!design->held()) {
    likelihood.event = FindTimedEffect(*design, likelihood, declared, out.fit, kEventSeed);
  }
  if (likelihood.event) SetClocksBy(*likelihood.event, likelihood.event->start_s, design);

  for (int pass = 0; pass < 2; ++pass) {
    likelihood.no_nuisance.clear();
    likelihood.no_nuisance = ImplausibleNuisances(*design, likelihood, declared);
    out.fit = FitWhitened(*design, likelihood, declared);
    if (pass == 0) {
      const Eigen::VectorXd residual = LeftOver(out.fit, likelihood.used);
      LearnNoise(*design, WithoutEvent(*design, likelihood, residual), declared.balance,
                 &likelihood);
    }
    const Problem problem = MakeProblem(*design, likelihood, declared, out.fit);
    const Eigen::VectorXd rest = Richest(problem);
    out.richest_rms = problem.scale * identify::Rms(rest);
    LearnNoise(*design, rest, declared.balance, &likelihood);
    if (pass == 0 && declared.balance == effects::Balance::kMotion) {
      LeaveOutliers(*design, rest, &likelihood);
    }
  }
  likelihood.no_nuisance.clear();
  likelihood.no_nuisance = ImplausibleNuisances(*design, likelihood, declared);
  out.fit = FitWhitened(*design, likelihood, declared);
  design->PredictDrive(out.fit.model);
  return out;
}

Likelihood CompareBands(identify::Design* other, const actuator::JointModel& declared,
                        Problem* problem) {
  const LikelihoodFit base = EstimateLikelihood(other, declared, problem->in_force());
  const Problem there = MakeProblem(*other, base.likelihood, declared, base.fit);
  const auto fit = [](const Problem& at, std::size_t h) { return FitSet(at.choices(), {h}); };
  // By name, at its best shape.
  std::map<std::string, EffectSet> best;
  for (std::size_t h = 0; h < there.hypotheses().size(); ++h) {
    if (!there.hypotheses()[h].follows_rates()) continue;
    EffectSet single = fit(there, h);
    EffectSet& so_far = best[there.hypotheses()[h].name];
    if (so_far.empty() || single.net > so_far.net) so_far = std::move(single);
  }
  for (std::size_t h = 0; h < problem->hypotheses().size(); ++h) {
    Hypothesis& here = problem->bank.hypotheses[h];
    if (!here.follows_rates()) continue;
    const EffectSet single = fit(*problem, h), &other_single = best[here.name];
    // Another shape is another column, and what shows nothing there agrees with anything.
    const bool same = here.physical() &&
                      other_single.net > problem->in_force().Limit(rules::kEvidence) &&
                      there.hypotheses()[other_single.members.front()].settings.front().psi ==
                          here.settings.front().psi;
    if (same) {
      const Eigen::VectorXd size = problem->scale * single.c;
      const Eigen::VectorXd other_size = there.scale * other_single.c;
      here.steady =
          (other_size - size).norm() < kSteadyWithin * std::min(size.norm(), other_size.norm());
    }
    if (!here.steady) here.charge += std::max(0.0, single.net - std::max(0.0, other_single.net));
  }
  return base.likelihood;
}

actuator::JointModel ModelWith(const actuator::JointModel& declared, const Problem& problem,
                               const EffectSet& set, std::vector<std::vector<int>>* terms) {
  actuator::JointModel model = declared;
  terms->clear();
  Eigen::Index k = 0;
  for (const std::size_t member : set.members) {
    const Hypothesis& h = problem.hypotheses()[member];
    terms->emplace_back();
    for (const TermSetting& setting : h.settings) {
      actuator::Term term;
      term.effect = h.effect;
      term.declared = false;
      for (std::size_t i = 0; i < setting.columns.size(); ++i, ++k) {
        term.linear.push_back({.value = problem.scale * set.c[k], .half_width_95 = std::nullopt});
      }
      const auto& infos = h.effect->info().nonlinear;
      for (std::size_t i = 0; i < setting.psi.size(); ++i) {
        actuator::ParameterValue value{.value = setting.psi[i], .half_width_95 = std::nullopt};
        // Counts stay whole, instants and spans were searched.
        value.fixed = infos[i].dimension == effects::Dimension::kNone || h.effect->info().event ||
                      h.effect->info().follows_record;
        term.nonlinear.push_back(value);
      }
      terms->back().push_back(static_cast<int>(model.terms.size()));
      model.terms.push_back(std::move(term));
    }
  }
  return model;
}

}  // namespace sinew::trace

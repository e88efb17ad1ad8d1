#include "components/model/trace/event_search.h"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "components/model/identify/statistics.h"
#include "components/model/trace/candidates.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

namespace {

constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
// Used rows that have to lie before and after a change.
constexpr std::size_t kRowsAside = 30;
// A change in another recording is the same when its size is within this factor.
constexpr double kSameChange = 2.0;
constexpr int kSignFlipRounds = 199;

// The effect acting all the time, every row.
Eigen::VectorXd Acting(const identify::Design& design, const effects::Effect& effect) {
  std::vector<double> psi(effect.info().nonlinear.size(), 0.0);
  psi[0] = identify::kLongBefore;
  return design.Columns(effect, psi).col(0);
}

struct ChangePoint {
  double start_s = kNowhere;
  double explained = 0.0;
  double theta = 0.0;
};

// Whitened rows of the search for a change.
struct StepScan {
  Eigen::VectorXd g, e;
  Eigen::MatrixXd X, inverse;
  std::vector<std::vector<Eigen::Index>> by_run;  // numbers of used rows

  // Best instant of one recording; sign: of every row's residual (1, or a sign-flip null test's).
  ChangePoint Best(std::size_t run, const std::vector<double>& time_s,
                   const std::vector<signed char>& sign) const {
    ChangePoint best;
    double ge = 0.0, gg = 0.0;
    Eigen::VectorXd xg = Eigen::VectorXd::Zero(X.cols());
    const std::vector<Eigen::Index>& rows = by_run[run];
    for (std::size_t k = rows.size(); k-- > kRowsAside;) {
      const Eigen::Index i = rows[k];
      ge += g[i] * e[i] * sign[static_cast<std::size_t>(i)];
      gg += g[i] * g[i];
      xg += g[i] * X.row(i).transpose();
      // Every eighth row is dense enough.
      if (rows.size() - k < kRowsAside || k % 8 != 0) continue;
      const double power = gg - xg.dot(inverse * xg);
      if (!(power > 1e-6 * gg)) continue;
      const double explained = ge * ge / power;
      if (explained > best.explained) {
        best = {0.5 * (time_s[static_cast<std::size_t>(i)] +
                       time_s[static_cast<std::size_t>(rows[k - 1])]),
                explained, ge / power};
      }
    }
    return best;
  }
};

// The change that explains most, of one size in all recordings that have it, beyond what the same
// search finds in residuals of random sign; residual of every row, in units of the balance.
std::optional<FoundEvent> FindChange(const identify::Design& design,
                                     std::shared_ptr<const effects::Effect> effect,
                                     const Likelihood& likelihood, const identify::FitResult& fit,
                                     const Eigen::VectorXd& residual, std::uint64_t seed) {
  const UsedRows& used = likelihood.used;
  const std::size_t runs = design.states().run_names.size();
  StepScan scan;
  // target = -phi theta + ..., as everywhere in the balance.
  scan.g = Whiten(likelihood, -Acting(design, *effect)(used.rows)).col(0);
  scan.e = Whiten(likelihood, residual(used.rows)).col(0);
  scan.X = Whiten(likelihood, used.Of(fit.balance.columns));
  scan.inverse = identify::Inverse(scan.X.transpose() * scan.X);
  scan.by_run.resize(runs);
  std::vector<double> time_s;
  for (Eigen::Index k = 0; k < used.size(); ++k) {
    const Eigen::Index row = used.rows[static_cast<std::size_t>(k)];
    scan.by_run[design.rows().RunOf(row)].push_back(k);
    time_s.push_back(design.rows().time_s[row]);
  }
  std::vector<signed char> sign(static_cast<std::size_t>(used.size()), 1);
  std::vector<ChangePoint> changes;
  std::size_t first = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    changes.push_back(scan.Best(run, time_s, sign));
    if (changes[run].explained > changes[first].explained) first = run;
  }
  // The same search in what all changes leave, with random signs of whole blocks.
  const auto own = static_cast<Eigen::Index>(runs);
  Eigen::MatrixXd joint(used.size(), scan.X.cols() + own);
  joint.leftCols(scan.X.cols()) = scan.X;
  joint.rightCols(own).setZero();
  for (std::size_t run = 0; run < runs; ++run) {
    for (const Eigen::Index k : scan.by_run[run]) {
      if (time_s[static_cast<std::size_t>(k)] > changes[run].start_s) {
        joint(k, scan.X.cols() + static_cast<Eigen::Index>(run)) = scan.g[k];
      }
    }
  }
  const Eigen::VectorXd c = identify::Solve(joint.transpose() * joint, joint.transpose() * scan.e);
  const double before =
      (scan.e - scan.X * (scan.inverse * (scan.X.transpose() * scan.e))).squaredNorm();
  scan.e -= joint * c;
  const double all = before - scan.e.squaredNorm();
  for (std::size_t run = 0; run < runs; ++run) {
    changes[run].theta = c[scan.X.cols() + static_cast<Eigen::Index>(run)];
  }
  std::mt19937_64 random(seed);
  std::vector<double> sign_flip;
  for (int round = 0; round < kSignFlipRounds; ++round) {
    for (const identify::Block& block : used.blocks) {
      const signed char s = (random() & 1) != 0 ? 1 : -1;
      for (const Eigen::Index k : block) sign[static_cast<std::size_t>(k)] = s;
    }
    double sum = 0.0;
    for (std::size_t run = 0; run < runs; ++run) {
      sum += scan.Best(run, time_s, sign).explained;
    }
    sign_flip.push_back(sum);
  }
  FoundEvent out;
  out.event.effect = std::move(effect);
  out.event.clock_s = changes[first].start_s;
  out.event.start_s.resize(runs);
  out.event.charge = identify::Quantile(sign_flip, 0.5);
  std::size_t alike = 0;
  for (std::size_t run = 0; run < runs; ++run) {
    const double ratio = changes[run].theta / changes[first].theta;
    if (!(ratio > 1.0 / kSameChange) || !(ratio < kSameChange)) continue;
    out.event.start_s[run].push_back(changes[run].start_s);
    out.explained += changes[run].explained;
    ++alike;
  }
  // One size in every recording is no accident, whatever else the residual holds. Where only some
  // have it, they alone have to exceed what the search finds anywhere in all of them.
  const bool found = alike == runs && runs > 1
                         ? all > identify::Quantile(sign_flip, 0.5)
                         : out.explained > identify::Quantile(sign_flip, 0.99);
  if (!found) return std::nullopt;
  return out;
}

// The instant, per recording, from which the effect with size theta explains most; none where it
// explains nothing.
std::vector<std::vector<double>> LocateChanges(const identify::Design& design,
                                               const effects::Effect& effect, double theta,
                                               const Eigen::VectorXd& residual) {
  const std::size_t runs = design.states().run_names.size();
  std::vector<std::vector<double>> out(runs);
  const Eigen::VectorXd g = theta * Acting(design, effect);
  const identify::Rows& rows = design.rows();
  std::vector<double> sum(runs, 0.0), most(runs, 0.0);
  for (Eigen::Index i = rows.size() - 1; i >= 0; --i) {
    if (!rows.used[static_cast<std::size_t>(i)]) continue;
    const std::size_t run = rows.RunOf(i);
    sum[run] -= g[i] * (2.0 * residual[i] + g[i]);
    if (sum[run] <= most[run]) continue;
    most[run] = sum[run];
    out[run] = {rows.time_s[i]};
  }
  return out;
}

}  // namespace

std::vector<double> TimedEffect::Psi() const {
  std::vector<double> psi = {clock_s};
  if (passing()) psi.push_back(length_s);
  return psi;
}

std::optional<TimedEffect> FindTimedEffect(const identify::Design& design,
                                           const Likelihood& likelihood,
                                           const actuator::JointModel& declared,
                                           const identify::FitResult& fit, std::uint64_t seed) {
  if (declared.balance != effects::Balance::kMotion || design.states().locked ||
      design.options().state_cutoff_Hz <= 0.0) {
    return std::nullopt;
  }
  const Eigen::VectorXd residual = fit.balance.target - fit.balance.columns * fit.coefficients;
  const double scale = fit.balance.Unit(fit.coefficients);
  const double dry_friction = DryFriction(fit.model);
  std::optional<FoundEvent> best;
  for (const Candidate& candidate : EventCandidates(declared, likelihood.in_force)) {
    const bool passes = candidate.effect->info().nonlinear.size() > 1;
    std::optional<FoundEvent> found =
        passes ? FindPush(design, candidate.effect, dry_friction / scale,
                          declared.backlash_rad > 0.0, residual, likelihood.in_force)
               : FindChange(design, candidate.effect, likelihood, fit, residual, seed);
    if (found && (!best || found->explained > best->explained)) best = std::move(found);
  }
  if (!best) return std::nullopt;
  best->event.dry_friction = dry_friction;
  return std::move(best->event);
}

std::vector<std::vector<double>> LocateTimedEffect(const identify::Design& design,
                                                   const TimedEffect& event, double theta,
                                                   const Eigen::VectorXd& residual) {
  return event.passing() ? LocatePushes(design, event.length_s, theta, event.dry_friction, residual)
                         : LocateChanges(design, *event.effect, theta, residual);
}

void SetClocksBy(const TimedEffect& event, const std::vector<std::vector<double>>& start_s,
                 identify::Design* design) {
  for (std::size_t run = 0; run < start_s.size(); ++run) {
    design->SetClock(static_cast<int>(run), start_s[run], event.clock_s);
  }
}

}  // namespace sinew::trace

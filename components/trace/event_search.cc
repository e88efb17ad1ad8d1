#include "components/trace/event_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <utility>

#include "components/identify/balance.h"
#include "components/identify/statistics.h"
#include "components/trace/candidates.h"
#include "components/trace/rules.h"
#include "components/trace/whitened_fit.h"

namespace sinew::trace {

namespace {

constexpr double kNeverBegins = -1e9;  // clock of a recording in which nothing began
constexpr double kNowhere = std::numeric_limits<double>::quiet_NaN();
// Used rows that have to lie before and after a change.
constexpr std::size_t kRowsAside = 30;
// An event in another recording is the same when its size is within this factor.
constexpr double kSameSize = 2.0;
// Periods of the angles' low-pass: what is shorter is an impact of teeth, not a push.
constexpr double kShortestPeriods = 1.5;
constexpr double kLongestShare = 0.1;  // of the shortest recording
// Share of a push's weight that has to be seen.
constexpr double kSeen = 0.35;
// Share of the limit for pushes that did not come as often in every recording.
constexpr double kUneven = 0.6;
constexpr std::size_t kMostPushes = 3;  // in a recording
constexpr int kPlaceboRounds = 199;

double Robust(std::vector<double> sizes) {
  return sizes.empty() ? 0.0 : identify::Quantile(std::move(sizes), 0.5) / 0.6745;
}

std::size_t RunOf(const identify::Rows& rows, Eigen::Index i) {
  return static_cast<std::size_t>(rows.run[static_cast<std::size_t>(i)]);
}

bool Moves(const identify::Design& design, Eigen::Index i) {
  const auto k = static_cast<std::size_t>(i);
  const identify::StateSegment& segment =
      design.states().segments[static_cast<std::size_t>(design.rows().segment[k])];
  const auto sample = static_cast<std::size_t>(design.rows().sample[k]);
  return segment.valid[sample] != 0 && segment.at_rest[sample] == 0;
}

// The effect acting all the time, every row.
Eigen::VectorXd Acting(const identify::Design& design, const effects::Effect& effect) {
  std::vector<double> psi(effect.info().nonlinear.size(), 0.0);
  psi[0] = kNeverBegins;
  return design.Columns(effect, psi).col(0);
}

// A residual with what each row of it weighs: one over its variance, 0 at rest.
struct Scan {
  Eigen::VectorXd residual, weight;
};

Scan MakeScan(const identify::Design& design, const Eigen::VectorXd& residual) {
  const identify::Rows& rows = design.rows();
  std::vector<double> used, masked;
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const bool counts = rows.used[static_cast<std::size_t>(i)] != 0;
    if (counts) used.push_back(std::abs(residual[i]));
    if (!counts && Moves(design, i)) masked.push_back(std::abs(residual[i]));
  }
  const double of_used = Robust(std::move(used));
  const double of_masked = std::max(of_used, Robust(std::move(masked)));
  Scan out{residual, Eigen::VectorXd::Zero(rows.size())};
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const bool counts = rows.used[static_cast<std::size_t>(i)] != 0;
    const double sigma = counts ? of_used : Moves(design, i) ? of_masked : 0.0;
    if (sigma > 0.0) out.weight[i] = 1.0 / (sigma * sigma);
  }
  return out;
}

struct Response {
  double start_s = kNowhere;
  double projection = 0.0;  // of the residual on the unit pulse
  double power = 0.0;       // of the pulse
  double size() const { return power > 0.0 ? projection / std::sqrt(power) : 0.0; }
};

// Pulses of one length that begin anywhere in a recording, an eighth of their length apart.
std::vector<Response> Responses(const identify::Design& design, const Scan& scan, std::size_t run,
                                double length_s) {
  const identify::Rows& rows = design.rows();
  const double largest = scan.weight.size() > 0 ? scan.weight.maxCoeff() : 0.0;
  const double expected = 0.375 * length_s * design.rows_per_s() * largest;  // mean of sin^4
  const auto step =
      std::max<Eigen::Index>(1, static_cast<Eigen::Index>(length_s * design.rows_per_s() / 8.0));
  std::vector<Response> out;
  for (Eigen::Index k = 0; k < rows.size(); k += step) {
    if (RunOf(rows, k) != run) continue;
    Response r{rows.time_s[k], 0.0, 0.0};
    for (Eigen::Index j = k; j < rows.size() && RunOf(rows, j) == run; ++j) {
      const double s = (rows.time_s[j] - r.start_s) / length_s;
      if (s >= 1.0) break;
      const double z = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * s);
      r.projection += scan.weight[j] * z * scan.residual[j];
      r.power += scan.weight[j] * z * z;
    }
    if (!(r.power > kSeen * expected)) continue;
    r.projection /= std::sqrt(r.power);
    out.push_back(r);
  }
  return out;
}

double ShortestRun(const identify::Design& design) {
  std::vector<double> first, last;
  const identify::Rows& rows = design.rows();
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const std::size_t run = RunOf(rows, i);
    if (run >= first.size()) {
      first.resize(run + 1, rows.time_s[i]);
      last.resize(run + 1, rows.time_s[i]);
    }
    last[run] = rows.time_s[i];
  }
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t run = 0; run < first.size(); ++run) {
    shortest = std::min(shortest, last[run] - first[run]);
  }
  return std::isfinite(shortest) ? shortest : 0.0;
}

struct Found {
  TimedEffect event;
  double explained = 0.0;  // misfit
};

// Pushes of one length, of one sign and size.
struct Pushes {
  double length_s = 0.0;
  double peak = 0.0;   // robust standard deviations of the filter's output
  double alone = 1.0;  // loudest elsewhere, share of the faintest of them
  std::vector<std::pair<std::size_t, Response>> all;  // by recording, loudest first
  double explained = 0.0;
  double positions = 0.0;  // that do not overlap

  // As often in every recording.
  bool Even(std::size_t runs) const {
    std::vector<int> count(runs, 0);
    for (const auto& [run, response] : all) ++count[run];
    return std::count(count.begin(), count.end(), count.front()) == static_cast<int>(runs);
  }
};

std::optional<Pushes> PushesOf(const identify::Design& design, const Scan& scan, double length_s) {
  const std::size_t runs = design.states().run_names.size();
  std::vector<std::pair<std::size_t, Response>> responses;
  std::vector<double> sizes;
  for (std::size_t run = 0; run < runs; ++run) {
    for (const Response& r : Responses(design, scan, run, length_s)) {
      responses.emplace_back(run, r);
      sizes.push_back(std::abs(r.projection));
    }
  }
  if (sizes.size() < 100) return std::nullopt;
  Pushes out;
  out.length_s = length_s;
  out.positions = static_cast<double>(sizes.size()) / 8.0;
  const double usual = Robust(std::move(sizes));
  if (!(usual > 0.0)) return std::nullopt;
  std::stable_sort(responses.begin(), responses.end(), [](const auto& a, const auto& b) {
    return std::abs(a.second.projection) > std::abs(b.second.projection);
  });
  // The loudest that stand apart: the motion goes on to answer for a while after it was pushed.
  std::vector<std::pair<std::size_t, Response>> peaks;
  for (const auto& [run, response] : responses) {
    const bool near = std::any_of(peaks.begin(), peaks.end(), [&](const auto& other) {
      return other.first == run &&
             std::abs(other.second.start_s - response.start_s) < 2.0 * length_s;
    });
    if (!near) peaks.emplace_back(run, response);
    if (peaks.size() > kMostPushes * runs) break;
  }
  out.peak = std::abs(peaks.front().second.projection) / usual;
  std::size_t count = 0;
  for (std::size_t m = 0; m + 1 < peaks.size(); ++m) {
    const double ratio = peaks[m].second.size() / peaks.front().second.size();
    if (!(ratio > 1.0 / kSameSize) || !(ratio < kSameSize)) break;
    const double gap =
        std::abs(peaks[m + 1].second.projection) / std::abs(peaks[m].second.projection);
    if (gap >= out.alone) continue;
    out.alone = gap;
    count = m + 1;
  }
  out.all.assign(peaks.begin(), peaks.begin() + static_cast<std::ptrdiff_t>(count));
  for (const auto& [run, r] : out.all) out.explained += r.projection * r.projection;
  return out;
}

std::optional<Found> FindPush(const identify::Design& design,
                              std::shared_ptr<const effects::Effect> effect, const Scan& scan) {
  const std::size_t runs = design.states().run_names.size();
  const double shortest_s = kShortestPeriods / design.options().state_cutoff_Hz;
  const double longest_s = kLongestShare * ShortestRun(design);
  std::optional<Pushes> best;
  for (double length_s = shortest_s; length_s <= longest_s; length_s *= std::numbers::sqrt2) {
    std::optional<Pushes> pushes = PushesOf(design, scan, length_s);
    if (!pushes || !(pushes->peak > rules::kEventPeak.limit)) continue;
    // What comes as often in every recording, with one size, is less of a chance.
    const double limit = (pushes->Even(runs) ? 1.0 : kUneven) * rules::kEventAlone.limit;
    if (pushes->alone > limit) continue;
    if (!best || pushes->explained > best->explained) best = std::move(pushes);
  }
  if (!best) return std::nullopt;
  Found out;
  out.event.effect = std::move(effect);
  out.event.length_s = best->length_s;
  out.event.clock_s = best->all.front().second.start_s;
  out.event.start_s.resize(runs);
  for (const auto& [run, r] : best->all) out.event.start_s[run].push_back(r.start_s);
  for (std::vector<double>& starts : out.event.start_s) std::sort(starts.begin(), starts.end());
  out.explained = best->explained;
  out.event.charge = 2.0 * static_cast<double>(best->all.size()) *
                     (1.0 + std::log(std::max(1.0, best->positions)));
  return out;
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

  // Best instant of one recording; sign: of every row's residual (1, or a placebo's).
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

std::optional<Found> FindStep(const identify::Design& design,
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
    scan.by_run[RunOf(design.rows(), row)].push_back(k);
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
  std::vector<double> placebo;
  for (int round = 0; round < kPlaceboRounds; ++round) {
    for (const identify::Block& block : used.blocks) {
      const signed char s = (random() & 1) != 0 ? 1 : -1;
      for (const Eigen::Index k : block) sign[static_cast<std::size_t>(k)] = s;
    }
    double sum = 0.0;
    for (std::size_t run = 0; run < runs; ++run) {
      sum += scan.Best(run, time_s, sign).explained;
    }
    placebo.push_back(sum);
  }
  const double noise = identify::Quantile(placebo, 0.99);
  // One size in every recording is no accident, whatever else the residual holds.
  const bool alike = std::all_of(changes.begin(), changes.end(), [&](const ChangePoint& change) {
    const double ratio = change.theta / changes[first].theta;
    return ratio > 1.0 / kSameSize && ratio < kSameSize;
  });
  if (!(all > (alike && runs > 1 ? identify::Quantile(placebo, 0.5) : noise))) return std::nullopt;
  Found out;
  out.event.effect = std::move(effect);
  out.event.clock_s = changes[first].start_s;
  out.event.start_s.resize(runs);
  out.event.charge = identify::Quantile(placebo, 0.5);
  for (std::size_t run = 0; run < runs; ++run) {
    const double ratio = changes[run].theta / changes[first].theta;
    if (!(ratio > 1.0 / kSameSize) || !(ratio < kSameSize)) continue;
    out.event.start_s[run].push_back(changes[run].start_s);
    out.explained += changes[run].explained;
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
  const Scan scan = MakeScan(design, residual);
  std::optional<Found> best;
  for (const Candidate& candidate : EventCandidates(declared)) {
    const bool passes = candidate.effect->info().nonlinear.size() > 1;
    std::optional<Found> found =
        passes ? FindPush(design, candidate.effect, scan)
               : FindStep(design, candidate.effect, likelihood, fit, residual, seed);
    if (found && (!best || found->explained > best->explained)) best = std::move(found);
  }
  if (!best) return std::nullopt;
  return std::move(best->event);
}

std::vector<std::vector<double>> LocateTimedEffect(const identify::Design& design,
                                                   const TimedEffect& event, double theta,
                                                   const Eigen::VectorXd& residual) {
  const std::size_t runs = design.states().run_names.size();
  std::vector<std::vector<double>> out(runs);
  const Scan scan = MakeScan(design, residual);
  if (event.passing()) {
    for (std::size_t run = 0; run < runs; ++run) {
      std::vector<std::pair<double, double>> gains;  // residual^2 - (residual + theta z)^2
      for (const Response& r : Responses(design, scan, run, event.length_s)) {
        const double gain = -theta * (2.0 * r.projection * std::sqrt(r.power) + theta * r.power);
        // More than half of what the push itself would explain.
        if (gain > 0.5 * theta * theta * r.power) gains.emplace_back(gain, r.start_s);
      }
      std::sort(gains.rbegin(), gains.rend());
      for (const auto& [gain, start_s] : gains) {
        const bool near = std::any_of(out[run].begin(), out[run].end(), [&](double other) {
          return std::abs(other - start_s) < 2.0 * event.length_s;
        });
        if (!near && out[run].size() < kMostPushes) out[run].push_back(start_s);
      }
      std::sort(out[run].begin(), out[run].end());
    }
    return out;
  }
  const Eigen::VectorXd g = theta * Acting(design, *event.effect);
  const identify::Rows& rows = design.rows();
  std::vector<double> sum(runs, 0.0), most(runs, 0.0);
  for (Eigen::Index i = rows.size() - 1; i >= 0; --i) {
    if (!rows.used[static_cast<std::size_t>(i)]) continue;
    const std::size_t run = RunOf(rows, i);
    sum[run] -= g[i] * (2.0 * residual[i] + g[i]);
    if (sum[run] <= most[run]) continue;
    most[run] = sum[run];
    out[run] = {rows.time_s[i]};
  }
  return out;
}

void SetClocksBy(const TimedEffect& event, const std::vector<std::vector<double>>& start_s,
                 identify::Design* design) {
  for (std::size_t run = 0; run < start_s.size(); ++run) {
    design->SetClock(static_cast<int>(run), start_s[run], event.clock_s);
  }
}

}  // namespace sinew::trace

#include "components/trace/events.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "components/identify/statistics.h"

namespace sinew::trace {

namespace {

constexpr double kNever = -1e9;  // clock offset of a recording in which nothing began
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Moving rows that have to lie before and after a change.
constexpr std::size_t kFewestRows = 30;
// A change in another recording is the same event when its size is within this factor.
constexpr double kAlike = 2.0;
// The search took the best instants out of what the placebo flips: its false finds come out small.
constexpr double kMargin = 2.0;
// Shorter is an impact of teeth, not a push.
constexpr double kShortestPush_s = 0.15;
// Passing events: share of a push's rows that must be used for the filter to say anything; how loud
// the next one may be: of the loudest, and of kLoudest where that is more.
constexpr double kSeenShare = 0.35;
constexpr double kNextLoudest = 0.45, kNextLoudestOrdinary = 0.6;

std::vector<std::vector<Eigen::Index>> UsedByRun(const identify::Design& design) {
  std::vector<std::vector<Eigen::Index>> out(design.states().run_names.size());
  for (const Eigen::Index i : design.rows().UsedRows()) {
    out[static_cast<std::size_t>(design.rows().run[static_cast<std::size_t>(i)])].push_back(i);
  }
  return out;
}

// The effect acting all the time, every row.
Eigen::VectorXd FullOn(const identify::Design& design, const effects::Effect& effect) {
  std::vector<double> psi;
  for (const effects::ParameterInfo& info : effect.info().nonlinear) {
    psi.push_back(info.default_value);
  }
  psi[0] = kNever;
  return design.Columns(effect, psi).col(0);
}

struct Change {
  double start_s = kNaN;
  double explained = 0.0;
  double theta = 0.0;
};

// Best change point of one recording. g: the effect acting; r: target; B, inverse: base.
Change BestChange(const std::vector<Eigen::Index>& rows, const Eigen::VectorXd& time_s,
                  const Eigen::Ref<const Eigen::VectorXd>& g,
                  const Eigen::Ref<const Eigen::VectorXd>& r,
                  const Eigen::Ref<const Eigen::MatrixXd>& base, const Eigen::MatrixXd& inverse) {
  Change best;
  double gr = 0.0;
  double gg = 0.0;
  Eigen::VectorXd bg = Eigen::VectorXd::Zero(base.cols());
  for (std::size_t k = rows.size(); k-- > kFewestRows;) {
    const Eigen::Index i = rows[k];
    gr += g[i] * r[i];
    gg += g[i] * g[i];
    bg += g[i] * base.row(i).transpose();
    if (rows.size() - k < kFewestRows) continue;
    const double power = gg - bg.dot(inverse * bg);
    if (!(power > 1e-6 * gg)) continue;
    const double explained = gr * gr / power;
    if (explained > best.explained) {
      // Between this row and the one before it.
      best = {0.5 * (time_s[i] + time_s[rows[k - 1]]), explained, gr / power};
    }
  }
  return best;
}

Event FindLasting(const identify::Design& design, std::shared_ptr<const effects::Effect> effect,
                  const std::vector<identify::Block>& blocks,
                  const Eigen::Ref<const Eigen::MatrixXd>& base,
                  const Eigen::Ref<const Eigen::VectorXd>& target, int placebo_rounds,
                  std::uint64_t seed) {
  Event out;
  // target = -phi theta + ..., as everywhere in the balance.
  const Eigen::VectorXd g = -FullOn(design, *effect);
  out.effect = std::move(effect);
  const auto runs = UsedByRun(design);
  out.start_s.assign(runs.size(), kNaN);
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(base.cols(), base.cols());
  for (const auto& rows : runs) {
    for (const Eigen::Index i : rows) gram += base.row(i).transpose() * base.row(i);
  }
  const Eigen::MatrixXd inverse = identify::Inverse(gram);
  const Eigen::VectorXd& time_s = design.rows().time_s;
  std::vector<Change> changes;
  std::size_t first = 0;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    changes.push_back(BestChange(runs[run], time_s, g, target, base, inverse));
    if (changes[run].explained > changes[first].explained) first = run;
  }
  if (changes.empty() || !(changes[first].explained > 0.0)) return out;

  // All changes together beside the base: each run's was found while the base had taken up a part
  // of the others.
  const auto count = static_cast<Eigen::Index>(runs.size());
  Eigen::MatrixXd all(target.size(), base.cols() + count);
  all.leftCols(base.cols()) = base;
  all.rightCols(count).setZero();
  std::vector<Eigen::Index> used;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    used.insert(used.end(), runs[run].begin(), runs[run].end());
    if (!std::isfinite(changes[run].start_s)) continue;
    for (const Eigen::Index i : runs[run]) {
      if (time_s[i] > changes[run].start_s) {
        all(i, base.cols() + static_cast<Eigen::Index>(run)) = g[i];
      }
    }
  }
  const identify::Moments total = identify::MomentsOf(used, all, target);
  const Eigen::VectorXd joint = identify::Solve(total.G, total.m);
  out.statistic = total.yy - total.SquaredError(joint);
  for (std::size_t run = 0; run < runs.size(); ++run) {
    changes[run].theta = joint[base.cols() + static_cast<Eigen::Index>(run)];
  }

  // What the same search finds in the rest, where there is no change: sums over blocks, signs of
  // whole blocks at random, changes at the borders of blocks.
  const Eigen::VectorXd noise = target - all * joint;
  struct BlockSums {
    int run;
    double gr, gg;
    Eigen::VectorXd bg;
  };
  std::vector<BlockSums> sums;
  for (const identify::Block& block : blocks) {
    if (block.empty()) continue;
    BlockSums part{design.rows().run[static_cast<std::size_t>(block.front())], 0.0, 0.0,
                   Eigen::VectorXd::Zero(base.cols())};
    for (const Eigen::Index i : block) {
      part.gr += g[i] * noise[i];
      part.gg += g[i] * g[i];
      part.bg += g[i] * base.row(i).transpose();
    }
    sums.push_back(std::move(part));
  }
  std::vector<double> power(sums.size(), 0.0);
  double gg = 0.0;
  Eigen::VectorXd bg = Eigen::VectorXd::Zero(base.cols());
  for (std::size_t b = sums.size(); b-- > 0;) {
    if (b + 1 < sums.size() && sums[b].run != sums[b + 1].run) {
      gg = 0.0;
      bg.setZero();
    }
    gg += sums[b].gg;
    bg += sums[b].bg;
    const double free = gg - bg.dot(inverse * bg);
    power[b] = free > 1e-6 * gg ? free : 0.0;
  }
  std::mt19937_64 random(seed);
  std::vector<double> best_false;
  for (int round = 0; round < placebo_rounds; ++round) {
    double sum = 0.0;  // over recordings, of the best in each
    double best = 0.0;
    double gr = 0.0;
    for (std::size_t b = sums.size(); b-- > 0;) {
      if (b + 1 < sums.size() && sums[b].run != sums[b + 1].run) {
        gr = 0.0;
        sum += best;
        best = 0.0;
      }
      gr += (random() & 1) != 0 ? sums[b].gr : -sums[b].gr;
      if (power[b] > 0.0) best = std::max(best, gr * gr / power[b]);
    }
    best_false.push_back(sum + best);
  }
  out.threshold = kMargin * identify::Quantile(best_false, 0.99);
  out.significant = out.statistic > out.threshold;

  out.clock_s = changes[first].start_s;
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const double ratio = changes[run].theta / changes[first].theta;
    // Less than a tenth of the threshold is no sign of a change here.
    if (changes[run].explained < 0.1 * out.threshold / static_cast<double>(count) ||
        ratio < 1.0 / kAlike || ratio > kAlike) {
      continue;
    }
    out.start_s[run] = changes[run].start_s;
    out.explained += changes[run].explained;
  }
  return out;
}

struct Push {
  double start_s = kNaN;
  double response = 0.0;  // projection of the target on the unit pulse
  double power = 0.0;
};

// Responses of the pulse of one length, beginning at every row of a recording, used or not; none
// where too little of it is seen.
std::vector<Push> MatchedFilter(const identify::Design& design, int run, double length_s,
                                const Eigen::Ref<const Eigen::VectorXd>& target) {
  const identify::Rows& rows = design.rows();
  const double expected = length_s * design.rows_per_s();
  std::vector<Push> out;
  for (Eigen::Index k = 0; k < rows.size(); ++k) {
    if (rows.run[static_cast<std::size_t>(k)] != run) continue;
    const double start = rows.time_s[k];
    double zr = 0.0;
    double zz = 0.0;
    double seen = 0.0;
    for (Eigen::Index j = k; j < rows.size(); ++j) {
      const auto at = static_cast<std::size_t>(j);
      const double s = (rows.time_s[j] - start) / length_s;
      if (s >= 1.0 || rows.run[at] != run) break;
      if (!rows.used[at]) continue;
      const double z = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * s);
      zr += z * target[j];
      zz += z * z;
      seen += 1.0;
    }
    if (seen < kSeenShare * expected || seen < 4.0 || !(zz > 0.1 * expected)) continue;
    out.push_back({start, zr / std::sqrt(zz), zz});
  }
  return out;
}

Event FindPassing(const identify::Design& design, std::shared_ptr<const effects::Effect> effect,
                  const Eigen::Ref<const Eigen::VectorXd>& target) {
  Event out;
  out.threshold = kLoudest;
  const std::size_t runs = design.states().run_names.size();
  out.start_s.assign(runs, kNaN);
  const effects::ParameterInfo length = effect->info().nonlinear[1];
  std::size_t first = 0;
  double response = 0.0;
  double scale = 0.0;
  for (const double length_s : length.grid) {
    if (length_s * design.rows_per_s() < 4.0) continue;
    std::vector<std::vector<Push>> all;
    std::vector<double> sizes;
    for (std::size_t run = 0; run < runs; ++run) {
      all.push_back(MatchedFilter(design, static_cast<int>(run), length_s, target));
      for (const Push& push : all.back()) sizes.push_back(std::abs(push.response));
    }
    if (sizes.size() < 100) continue;
    const double ordinary = identify::RobustDeviation(sizes);
    if (!(ordinary > 0.0)) continue;
    for (std::size_t run = 0; run < all.size(); ++run) {
      for (const Push& push : all[run]) {
        if (std::abs(push.response) / ordinary <= out.statistic) continue;
        out.statistic = std::abs(push.response) / ordinary;
        out.length_s = length_s;
        out.clock_s = push.start_s;
        response = push.response / std::sqrt(push.power);
        scale = ordinary;
        first = run;
      }
    }
  }
  out.effect = std::move(effect);
  if (!(out.length_s > 0.0)) return out;

  // In the other recordings: the loudest of the same sign and size. And it may not come often.
  double next_loudest = 0.0;
  for (std::size_t run = 0; run < runs; ++run) {
    const std::vector<Push> pushes =
        MatchedFilter(design, static_cast<int>(run), out.length_s, target);
    Push best;
    for (const Push& push : pushes) {
      if (push.response * response <= 0.0) continue;
      if (std::abs(push.response) > std::abs(best.response)) best = push;
    }
    const double ratio = best.power > 0.0 ? best.response / std::sqrt(best.power) / response : 0.0;
    const bool here = run == first || (std::abs(best.response) > 0.6 * kLoudest * scale &&
                                       ratio > 1.0 / kAlike && ratio < kAlike);
    if (here) {
      out.start_s[run] = best.start_s;
      out.explained += best.response * best.response;
    }
    for (const Push& push : pushes) {
      if (here && std::abs(push.start_s - best.start_s) < 2.0 * out.length_s) continue;
      next_loudest = std::max(next_loudest, std::abs(push.response) / scale);
    }
  }
  // Pulses of several lengths about its middle, filtered like everything else: an impact is best
  // told by the shortest.
  const double middle = out.clock_s + 0.5 * out.length_s;
  double most = 0.0;
  double told_s = 0.0;
  std::vector<double> lengths = {0.04, 0.08, 0.12};
  lengths.insert(lengths.end(), length.grid.begin(), length.grid.end());
  const identify::Rows& rows = design.rows();
  for (const double length_s : lengths) {
    const std::vector<double> psi = {middle - 0.5 * length_s, length_s};
    const Eigen::VectorXd z = design.Columns(*out.effect, psi).col(0);
    double zr = 0.0;
    double zz = 0.0;
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (rows.run[k] != static_cast<int>(first) || !rows.used[k]) continue;
      zr += z[i] * target[i];
      zz += z[i] * z[i];
    }
    if (!(zz > 0.0) || zr * zr / zz <= most) continue;
    most = zr * zr / zz;
    told_s = length_s;
  }
  out.significant =
      told_s > kShortestPush_s && out.statistic > kLoudest &&
      next_loudest < std::max(kNextLoudest * out.statistic, kNextLoudestOrdinary * kLoudest);
  return out;
}

}  // namespace

Event FindEvent(const identify::Design& design, std::shared_ptr<const effects::Effect> effect,
                const std::vector<identify::Block>& blocks,
                const Eigen::Ref<const Eigen::MatrixXd>& base,
                const Eigen::Ref<const Eigen::VectorXd>& target, int placebo_rounds,
                std::uint64_t seed) {
  if (effect->info().nonlinear.size() > 1) return FindPassing(design, std::move(effect), target);
  return FindLasting(design, std::move(effect), blocks, base, target, placebo_rounds, seed);
}

std::vector<double> LocateEvent(const identify::Design& design, const Event& event, double theta,
                                const Eigen::Ref<const Eigen::VectorXd>& residual) {
  const auto runs = UsedByRun(design);
  const Eigen::VectorXd& time_s = design.rows().time_s;
  std::vector<double> out(runs.size(), kNaN);
  // Gain of theta phi from an instant on: residual^2 - (residual + theta phi)^2.
  if (!event.passing()) {
    const Eigen::VectorXd g = theta * FullOn(design, *event.effect);
    for (std::size_t run = 0; run < runs.size(); ++run) {
      double sum = 0.0;
      double best = 0.0;
      for (std::size_t k = runs[run].size(); k-- > 0;) {
        const Eigen::Index i = runs[run][k];
        sum -= g[i] * (2.0 * residual[i] + g[i]);
        if (sum <= best) continue;
        best = sum;
        out[run] = k > 0 ? 0.5 * (time_s[i] + time_s[runs[run][k - 1]]) : time_s[i];
      }
    }
    return out;
  }
  for (std::size_t run = 0; run < runs.size(); ++run) {
    double best = 0.0;
    for (const Push& push :
         MatchedFilter(design, static_cast<int>(run), event.length_s, residual)) {
      const double gain =
          -theta * (2.0 * push.response * std::sqrt(push.power) + theta * push.power);
      if (gain <= best) continue;
      best = gain;
      out[run] = push.start_s;
    }
  }
  return out;
}

void SetClocks(const std::vector<double>& start_s, double clock_s, identify::Design* design) {
  for (std::size_t run = 0; run < start_s.size(); ++run) {
    const double start = start_s[run];
    const double offset = std::isfinite(start) ? clock_s - start : kNever;
    design->SetClock(static_cast<int>(run), offset);
  }
}

}  // namespace sinew::trace

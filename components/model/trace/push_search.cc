#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "components/model/identify/statistics.h"
#include "components/model/trace/event_search.h"

namespace sinew::trace {

namespace {

// Periods of the angles' low-pass: where there is play, what is shorter is an impact of teeth, not
// a push. Without it half a period is the shortest that the low-pass leaves in one piece.
constexpr double kShortestWithPlay = 1.5, kShortest = 0.5;
constexpr double kLongestShare = 0.1;  // of the shortest recording
// Share of a push's weight that has to be seen.
constexpr double kSeen = 0.35;
// Pushes are the same when their sizes are within this factor.
constexpr double kSameSize = 2.0;
constexpr std::size_t kMostPushes = 3;  // in a recording
// Peaks below the pushes that bound the other peaks: half of the logarithm's digits of their scale
// are certain (error 1 / sqrt(10)).
constexpr std::size_t kBackground = 10;
constexpr double kNormal95 = 1.96;  // 95 % of normal values lie within

bool Moves(const identify::Design& design, Eigen::Index i) {
  const identify::StateSegment& segment = design.SegmentOf(i);
  const std::size_t sample = design.rows().SampleOf(i);
  return segment.valid[sample] != 0 && segment.at_rest[sample] == 0;
}

// A residual with what each row of it weighs: one over its variance, 0 at rest. Near standstill
// friction is anything up to its moving value either way: the balance is not known better there.
struct Scan {
  Eigen::VectorXd residual, weight;
};

Scan MakeScan(const identify::Design& design, double dry_friction,
              const Eigen::VectorXd& residual) {
  const identify::Rows& rows = design.rows();
  std::vector<double> used, masked;
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const bool counts = rows.used[static_cast<std::size_t>(i)] != 0;
    if (counts) used.push_back(std::abs(residual[i]));
    if (!counts && Moves(design, i)) masked.push_back(std::abs(residual[i]));
  }
  const double of_used = identify::RobustDeviation(std::move(used));
  // A joint that hardly moves may be stuck: what is usual there is no measure of what may happen.
  const double of_masked = std::hypot(
      masked.empty() ? of_used
                     : std::max(of_used, identify::Quantile(std::move(masked), 0.95) / kNormal95),
      dry_friction);
  Scan out{residual, Eigen::VectorXd::Zero(rows.size())};
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const bool counts = rows.used[static_cast<std::size_t>(i)] != 0;
    const double sigma = counts ? of_used : Moves(design, i) ? of_masked : 0.0;
    if (sigma > 0.0) out.weight[i] = 1.0 / (sigma * sigma);
  }
  return out;
}

struct Response {
  double start_s = 0.0;
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
    if (rows.RunOf(k) != run) continue;
    Response r{rows.time_s[k], 0.0, 0.0};
    for (Eigen::Index j = k; j < rows.size() && rows.RunOf(j) == run; ++j) {
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
    const std::size_t run = rows.RunOf(i);
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

// Pushes of one length, of one sign and size.
struct Pushes {
  double length_s = 0.0;
  double peak = 0.0;  // robust standard deviations of the filter's output
  double p = 1.0;     // of the gap below the faintest of them
  std::vector<std::pair<std::size_t, Response>> all;  // by recording, loudest first
  double explained = 0.0;
  double positions = 0.0;  // that do not overlap
};

// p of the gap between the k loudest peaks and those behind them. Spacings of the logarithms of the
// loudest values of any heavy tail, times their rank, are independent and exponential with one mean
// (Renyi 1953; Hill 1975); that of the gap over the mean of m others has the distribution
// F(2, 2 m). Light tails have smaller spacings at the top than behind it: p is then too large.
double GapP(const std::vector<double>& loudness, std::size_t k) {
  double others = 0.0;
  for (std::size_t i = k + 1; i <= k + kBackground; ++i) {
    others += static_cast<double>(i) * std::log(loudness[i - 1] / loudness[i]);
  }
  const auto m = static_cast<double>(kBackground);
  const double gap = static_cast<double>(k) * std::log(loudness[k - 1] / loudness[k]);
  return others > 0.0 ? std::pow(1.0 + gap / others, -m) : 0.0;
}

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
  const double usual = identify::RobustDeviation(std::move(sizes));
  if (!(usual > 0.0)) return std::nullopt;
  std::stable_sort(responses.begin(), responses.end(), [](const auto& a, const auto& b) {
    return std::abs(a.second.projection) > std::abs(b.second.projection);
  });
  // The loudest that stand apart: the motion goes on to answer for a while after it was pushed.
  std::vector<std::pair<std::size_t, Response>> peaks;
  for (const auto& [run, response] : responses) {
    const std::size_t of_run = run;
    const double start_s = response.start_s;
    const bool near = std::any_of(peaks.begin(), peaks.end(), [&](const auto& other) {
      return other.first == of_run && std::abs(other.second.start_s - start_s) < 2.0 * length_s;
    });
    if (!near) peaks.emplace_back(run, response);
    if (peaks.size() > kMostPushes * runs + kBackground) break;
  }
  if (peaks.size() < 2 + kBackground) return std::nullopt;
  out.peak = std::abs(peaks.front().second.projection) / usual;
  std::vector<double> loudness;
  loudness.reserve(peaks.size());
  for (const auto& [run, r] : peaks) loudness.push_back(std::abs(r.projection));
  std::size_t apart = 0;  // from the rest, all of one sign
  for (std::size_t k = 1; k + kBackground < peaks.size(); ++k) {
    if (!(peaks[k - 1].second.projection * peaks.front().second.projection > 0.0)) break;
    const double p = GapP(loudness, k);
    if (p >= out.p) continue;
    out.p = p;
    apart = k;
  }
  // The part that reaches the drive depends on where the teeth are: fainter ones are no other size.
  for (std::size_t k = 0; k < apart; ++k) {
    const double ratio = peaks[k].second.size() / peaks.front().second.size();
    if (ratio > 1.0 / kSameSize && ratio < kSameSize) out.all.push_back(peaks[k]);
  }
  for (const auto& [run, r] : out.all) out.explained += r.projection * r.projection;
  return out;
}

}  // namespace

std::optional<FoundEvent> FindPush(const identify::Design& design,
                                   std::shared_ptr<const effects::Effect> effect,
                                   double dry_friction, bool has_play,
                                   const Eigen::VectorXd& residual, const InForce& in_force) {
  const Scan scan = MakeScan(design, dry_friction, residual);
  const std::size_t runs = design.states().run_names.size();
  const double shortest_s =
      (has_play ? kShortestWithPlay : kShortest) / design.options().state_cutoff_Hz;
  const double longest_s = kLongestShare * ShortestRun(design);
  std::optional<Pushes> best;
  // Lengths overlap; numbers of pushes do not.
  const auto asked = static_cast<double>(kMostPushes * runs);
  for (double length_s = shortest_s; length_s <= longest_s; length_s *= std::numbers::sqrt2) {
    std::optional<Pushes> pushes = PushesOf(design, scan, length_s);
    if (!pushes || !(pushes->peak > in_force.Limit(rules::kEventPeak))) continue;
    if (!(asked * pushes->p < in_force.Limit(rules::kEventAlone))) continue;
    if (!best || pushes->explained > best->explained) best = std::move(pushes);
  }
  if (!best) return std::nullopt;
  FoundEvent out;
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

std::vector<std::vector<double>> LocatePushes(const identify::Design& design, double length_s,
                                              double theta, double dry_friction,
                                              const Eigen::VectorXd& residual) {
  const std::size_t runs = design.states().run_names.size();
  std::vector<std::vector<double>> out(runs);
  const Scan scan = MakeScan(design, dry_friction, residual);
  for (std::size_t run = 0; run < runs; ++run) {
    std::vector<std::pair<double, double>> gains;  // residual^2 - (residual + theta z)^2
    for (const Response& r : Responses(design, scan, run, length_s)) {
      const double gain = -theta * (2.0 * r.projection * std::sqrt(r.power) + theta * r.power);
      // More than half of what the push itself would explain.
      if (gain > 0.5 * theta * theta * r.power) gains.emplace_back(gain, r.start_s);
    }
    std::sort(gains.rbegin(), gains.rend());
    for (const std::pair<double, double>& found : gains) {
      const double start_s = found.second;
      const bool near = std::any_of(out[run].begin(), out[run].end(), [&](double other) {
        return std::abs(other - start_s) < 2.0 * length_s;
      });
      if (!near && out[run].size() < kMostPushes) out[run].push_back(start_s);
    }
    std::sort(out[run].begin(), out[run].end());
  }
  return out;
}

}  // namespace sinew::trace

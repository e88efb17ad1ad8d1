#include "components/model/trace/reported.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/model/identify/statistics.h"
#include "components/model/trace/sensitivity.h"

namespace sinew::trace {

using identify::Design;

namespace {

double FromStandstill(const identify::Design& design, const Eigen::VectorXd& torque) {
  const identify::Rows& rows = design.rows();
  const double settle_s = 1.0 / design.options().parallel_cutoff_Hz;
  double squares = 0.0;
  double freedom = 0.0;
  const auto close = [&](const std::vector<Eigen::Index>& spell) {
    const auto n = static_cast<double>(spell.size());
    if (n < 10.0) return;
    double mean_t = 0.0;
    double mean_y = 0.0;
    for (const Eigen::Index i : spell) {
      mean_t += rows.time_s[i] / n;
      mean_y += torque[i] / n;
    }
    double tt = 0.0;
    double ty = 0.0;
    double yy = 0.0;
    for (const Eigen::Index i : spell) {
      const double t = rows.time_s[i] - mean_t;
      const double y = torque[i] - mean_y;
      tt += t * t;
      ty += t * y;
      yy += y * y;
    }
    squares += yy - ty * ty / tt;
    freedom += n - 2.0;
  };
  for (std::size_t s = 0; s < design.states().segments.size(); ++s) {
    const identify::StateSegment& segment = design.states().segments[s];
    // Seconds since and until motion, at the full rate.
    const auto n = static_cast<std::size_t>(segment.size());
    std::vector<double> still(n, 0.0);
    double since = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
      since = segment.at_rest[i] ? since + segment.period_s : 0.0;
      still[i] = since;
    }
    since = 0.0;
    for (std::size_t i = n; i-- > 0;) {
      since = segment.at_rest[i] ? since + segment.period_s : 0.0;
      still[i] = std::min(still[i], since);
    }
    std::vector<Eigen::Index> spell;
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      const auto k = static_cast<std::size_t>(i);
      if (rows.segment[k] != static_cast<int>(s)) continue;
      if (still[static_cast<std::size_t>(rows.sample[k])] > settle_s) {
        spell.push_back(i);
      } else {
        close(spell);
        spell.clear();
      }
    }
    close(spell);
  }
  return freedom >= 30.0 ? std::sqrt(squares / freedom) : 0.0;
}

double FromDifferences(const identify::Design& design, double drive_gain) {
  double best = 0.0;
  for (const identify::StateSegment& segment : design.states().segments) {
    const Eigen::VectorXd& x = segment.drive_input;
    const double rate = 1.0 / segment.period_s;
    const double cutoff = design.options().parallel_cutoff_Hz;
    const bool filtered = cutoff < 0.5 * rate;
    if (x.size() < 100 || (filtered && cutoff > 0.4 * rate)) continue;
    const double sigma = identify::WhiteNoise({&x, 1});
    const double rms = drive_gain * sigma * (filtered ? std::sqrt(cutoff / (0.5 * rate)) : 1.0);
    best = best > 0.0 ? std::min(best, rms) : rms;
  }
  return best;
}

}  // namespace

NoiseFloor EstimateNoiseFloor(const identify::Design& design, const identify::Balance& balance,
                              double drive_factor) {
  Eigen::VectorXd torque = balance.target;
  if (balance.fits_scale) {
    torque = drive_factor * (balance.target - balance.columns.col(0) / drive_factor);
  }
  const double still = FromStandstill(design, torque);
  // Gain from drive input to torque, by their sizes.
  double input = 0.0;
  for (const identify::StateSegment& segment : design.states().segments) {
    input += segment.drive_input.squaredNorm() * segment.period_s * design.rows_per_s();
  }
  const double gain =
      !design.rows().window.empty() ? drive_factor  // levels are removed: sizes say nothing
      : input > 0.0 ? drive_factor * std::sqrt(balance.drive_torque.squaredNorm() / input)
                    : 0.0;
  const double high = FromDifferences(design, gain);
  if (still > 0.0 && (still <= high || high == 0.0)) return {still, "standstill"};
  if (high > 0.0) return {high, "sample-to-sample scatter"};
  return {0.0, ""};
}

LikelihoodFit Reported(const Design& train, const LikelihoodFit& base,
                       const actuator::JointModel& declared) {
  LikelihoodFit out = base;
  out.likelihood = Unweighted(base.likelihood, LeftOver(base.fit, base.likelihood.used));
  out.likelihood.no_nuisance.emplace_back(kRigidBodies);
  out.fit = FitWhitened(train, out.likelihood, declared);
  return out;
}

RowUsage UsageOf(const Design& train, const UsedRows& used) {
  constexpr std::array kReasons = {
      "lost or interpolated",    "border of a piece",           "rest",
      "near rest or a reversal", "near a contact of the teeth", "settling after rest",
      "alone or an outlier"};
  constexpr std::array kClasses = {1.0 / 30.0, 0.1, 1.0 / 3.0, 1.0};  // of the fastest row
  const identify::Rows& rows = train.rows();
  std::vector<char> is_used(static_cast<std::size_t>(rows.size()), 0);
  for (const Eigen::Index row : used.rows) is_used[static_cast<std::size_t>(row)] = 1;
  const Eigen::VectorXd speed =
      train.Variable([](const effects::JointSample& x) { return std::abs(x.velocity_rad_s); });
  RowUsage out;
  const double fastest = speed.size() > 0 ? speed.maxCoeff() : 0.0;
  for (const double share : kClasses) out.by_speed.push_back({share * fastest, 0, 0});
  std::array<Eigen::Index, kReasons.size()> count{};
  for (Eigen::Index i = 0; i < rows.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto at = std::find_if(out.by_speed.begin(), out.by_speed.end() - 1,
                                 [&](const auto& of) { return speed[i] <= of.up_to; });
    ++at->rows;
    at->used += is_used[k];
    if (is_used[k]) continue;
    const auto why = static_cast<std::size_t>(train.SegmentOf(i).use[rows.SampleOf(i)]);
    ++count[why > 0 ? why - 1 : kReasons.size() - 1];
  }
  for (std::size_t r = 0; r < kReasons.size(); ++r) {
    if (count[r] > 0) out.not_used.emplace_back(kReasons[r], count[r]);
  }
  return out;
}

void NoteErrors(const LikelihoodFit& reported, const actuator::JointModel& drive,
                Design* predicted_train, Design* predicted_held_out, TraceResult* result) {
  const Design &train = *predicted_train, &held_out = *predicted_held_out;
  const auto predict = [&](const actuator::JointModel& model) {
    predicted_train->PredictDrive(model);
    predicted_held_out->PredictDrive(model);
  };
  predict(result->nominal);
  result->nominal_train = identify::ErrorOf(train, result->nominal);
  result->nominal_held_out = identify::ErrorOf(held_out, result->nominal);
  predict(reported.fit.model);
  result->before_train = identify::ErrorOf(train, reported.fit.model, result->nominal);
  result->before_held_out = identify::ErrorOf(held_out, reported.fit.model, result->nominal);
  predict(drive);
  const double scale = reported.fit.balance.Unit(reported.fit.coefficients);
  const NoiseFloor floor = EstimateNoiseFloor(train, reported.fit.balance, scale);
  result->noise_floor_rms = floor.rms;
  result->noise_floor_source = floor.source;
  result->ceiling_rms = reported.richest_rms;
}

namespace {

const FoundEffect* Named(const std::vector<FoundEffect>& effects, const std::string& name) {
  const auto at = std::find_if(effects.begin(), effects.end(),
                               [&](const FoundEffect& effect) { return effect.name == name; });
  return at == effects.end() ? nullptr : &*at;
}

Verdict VerdictOf(const TraceResult& result) {
  const bool unexplained = !result.unexplained.variable.empty() || !result.open.empty() ||
                           (!result.refuted.empty() && !NearNoise(result));
  return !result.effects.empty() ? Verdict::kEffect
         : unexplained           ? Verdict::kUnexplained
                                 : Verdict::kNone;
}

}  // namespace

void Conclude(const Problem& problem, TraceResult* result) {
  for (CandidateScore& score : result->scores) {
    score.accepted = Named(result->effects, score.name) != nullptr;
    if (score.accepted) score.refused = {};
    for (const auto* list : {&result->open, &result->refuted}) {
      if (const FoundEffect* found = Named(*list, score.name)) score.refused = found->refusal;
    }
  }
  NoteSensitivity(problem, result);
  for (auto* list : {&result->effects, &result->open, &result->refuted}) SortByGain(list);
  result->verdict = VerdictOf(*result);
}

}  // namespace sinew::trace

#include "components/model/trace/reported.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "components/model/trace/noise_floor.h"

namespace sinew::trace {

using identify::Design;

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

void NoteOutcome(const TraceResult& result, std::vector<CandidateScore>* scores) {
  const auto holds = [](const std::vector<FoundEffect>& found, const std::string& name) {
    const auto at = std::find_if(found.begin(), found.end(),
                                 [&](const FoundEffect& effect) { return effect.name == name; });
    return at == found.end() ? nullptr : &*at;
  };
  for (CandidateScore& score : *scores) {
    score.accepted = holds(result.effects, score.name) != nullptr;
    if (score.accepted) score.refused = {};
    for (const auto* list : {&result.open, &result.refuted}) {
      if (const FoundEffect* found = holds(*list, score.name)) score.refused = found->refusal;
    }
  }
}

std::set<std::string> Shown(const TraceResult& result) {
  std::set<std::string> out;
  for (const auto* list : {&result.effects, &result.open}) {
    for (const FoundEffect& found : *list) out.insert(found.name);
  }
  return out;
}

Verdict VerdictOf(const TraceResult& result) {
  const bool unexplained = !result.unexplained.variable.empty() || !result.open.empty() ||
                           (!result.refuted.empty() && !NearNoise(result));
  return !result.effects.empty() ? Verdict::kEffect
         : unexplained           ? Verdict::kUnexplained
                                 : Verdict::kNone;
}

}  // namespace sinew::trace

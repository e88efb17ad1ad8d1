#include "components/trace/likelihood_tracer.h"

#include <algorithm>
#include <cmath>

#include "components/trace/ceiling.h"
#include "components/trace/judgement.h"
#include "components/trace/rules.h"
#include "components/trace/shift.h"

namespace sinew::trace {

namespace {

using identify::Design;
using identify::FitResult;

// Fewer independent blocks than this are weak evidence (Cameron, Miller 2015, section VI).
constexpr std::size_t kConvincingBlocks = 6;

// The declared model, fitted, with the terms of a set; terms: those of each member.
actuator::JointModel ModelWith(const actuator::JointModel& fitted, const Problem& problem,
                               const EffectSet& set, std::vector<std::vector<int>>* terms) {
  actuator::JointModel model = fitted;
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
        // Counts stay whole, instants were searched.
        value.fixed = infos[i].dimension == effects::Dimension::kNone || h.effect->info().event;
        term.nonlinear.push_back(value);
      }
      terms->back().push_back(static_cast<int>(model.terms.size()));
      model.terms.push_back(std::move(term));
    }
  }
  return model;
}

class Correction {
 public:
  Correction(Design& train, Design& sealed, const LikelihoodFit& base, const Problem& problem,
             const SetJudgement& judged)
      : train_(train), sealed_(sealed), base_(base), problem_(problem), judged_(judged) {}

  // Fits the set and confirms every member. A member that is wrong spoils the prediction of the
  // others: the refuted one that training misses least leaves, and the rest is confirmed anew.
  void Run(TraceResult* result) {
    corrected_ = base_.fit;
    set_ = judged_.chosen;
    rivals_ = judged_.rivals;
    while (!set_.empty()) {
      Fit();
      LocateEvent(result);
      std::vector<FoundEffect> found;
      std::optional<std::size_t> leaves;
      for (std::size_t k = 0; k < set_.members.size(); ++k) {
        found.push_back(Describe(k));
        if (found[k].confirmation.verdict != ConfirmationVerdict::kRefuted) continue;
        if (!leaves || found[k].gain_share < found[*leaves].gain_share) leaves = k;
      }
      if (!leaves) {
        result->effects = std::move(found);
        return;
      }
      found[*leaves].term = -1;
      result->refuted.push_back(std::move(found[*leaves]));
      result->events.clear();
      std::vector<std::size_t> kept = set_.members;
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(*leaves));
      rivals_.erase(rivals_.begin() + static_cast<std::ptrdiff_t>(*leaves));
      set_ = FitSet(problem_.evidence, problem_.hypotheses(), std::move(kept));
      corrected_ = base_.fit;
      PredictDrive(base_.fit.model);
    }
  }

  const FitResult& corrected() const { return corrected_; }

 private:
  void PredictDrive(const actuator::JointModel& model) {
    train_.PredictDrive(model);
    sealed_.PredictDrive(model);
  }

  // Twice: effects that read the drive see the one that the corrected model needs.
  void Fit() {
    actuator::JointModel model = ModelWith(base_.fit.model, problem_, set_, &terms_);
    for (int pass = 0; pass < 2; ++pass) {
      corrected_ = RefineWhitened(train_, base_.likelihood, model);
      model = corrected_.model;
      PredictDrive(model);
    }
  }

  // When it happens is no property of the robot: held-out recordings are searched for it with the
  // size that training gave.
  void LocateEvent(TraceResult* result) {
    const std::optional<TimedEffect>& event = base_.likelihood.event;
    if (!event) return;
    const int at = corrected_.model.Find(event->effect->info().name, corrected_.model.balance);
    if (at < 0) return;
    actuator::JointModel without = corrected_.model;
    const double theta = without.terms[static_cast<std::size_t>(at)].linear.front().value;
    without.terms.erase(without.terms.begin() + at);
    const std::vector<std::vector<double>> sealed_start_s =
        LocateTimedEffect(sealed_, *event, theta, identify::ErrorOf(sealed_, without).residual);
    SetClocksBy(*event, sealed_start_s, &sealed_);
    const auto note = [&](const Design& design, const std::vector<std::vector<double>>& start_s,
                          bool sealed) {
      for (std::size_t run = 0; run < start_s.size(); ++run) {
        for (const double start : start_s[run]) {
          result->events.push_back(
              {event->effect->info().name, design.states().run_names[run], sealed, start});
        }
      }
    };
    note(train_, event->start_s, false);
    note(sealed_, sealed_start_s, true);
  }

  FoundEffect Describe(std::size_t k) const {
    FoundEffect found;
    found.name = problem_.hypotheses()[set_.members[k]].name;
    found.balance = corrected_.model.balance;
    found.term = terms_[k].front();
    found.rivals = rivals_[k];
    std::vector<std::size_t> others = set_.members;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    const double without_it =
        FitSet(problem_.evidence, problem_.hypotheses(), std::move(others)).net;
    found.gain_share = (set_.net - without_it) / problem_.evidence.misfit();
    found.p = judged_.p_global;
    found.weak_evidence = base_.likelihood.used.blocks.size() < kConvincingBlocks;
    actuator::JointModel reduced = corrected_.model;
    for (auto at = terms_[k].rbegin(); at != terms_[k].rend(); ++at) {
      reduced.terms.erase(reduced.terms.begin() + *at);
    }
    const FitResult without = FitWhitened(train_, base_.likelihood, reduced);
    found.train_before = without.rms;
    found.train_after = corrected_.rms;
    found.sealed_before = identify::ErrorOf(sealed_, without.model).rms;
    found.sealed_after = identify::ErrorOf(sealed_, corrected_.model).rms;
    const int order = base_.likelihood.noise.order();
    found.confirmation =
        Confirm(sealed_, LikelihoodOf(sealed_, corrected_, order), without, corrected_);
    // Not finite where the drive that the effect asks for runs away. A slope that is confirmed
    // weighs more than a plain error, which a few rows near reversals may decide.
    const bool raises = found.sealed_after > rules::kRaises.limit * found.sealed_before;
    const bool confirmed = found.confirmation.verdict == ConfirmationVerdict::kConfirmed;
    if (!std::isfinite(found.sealed_after) || (raises && !confirmed)) {
      found.confirmation.verdict = ConfirmationVerdict::kRefuted;
    }
    return found;
  }

  Design& train_;
  Design& sealed_;
  const LikelihoodFit& base_;
  const Problem& problem_;
  const SetJudgement& judged_;
  EffectSet set_;  // what is left of the chosen one
  std::vector<std::vector<std::string>> rivals_;
  FitResult corrected_;
  std::vector<std::vector<int>> terms_;  // of the corrected model, by member
};

void NoteErrors(const Design& train, const Design& sealed, const LikelihoodFit& base,
                TraceResult* result) {
  result->nominal_train = identify::ErrorOf(train, result->nominal);
  result->nominal_sealed = identify::ErrorOf(sealed, result->nominal);
  result->before_train = identify::ErrorOf(train, base.fit.model);
  result->before_sealed = identify::ErrorOf(sealed, base.fit.model);
  const double scale =
      base.fit.balance.fits_scale ? base.fit.balance.Scale(base.fit.coefficients) : 1.0;
  const NoiseFloor floor = EstimateNoiseFloor(train, base.fit.balance, scale);
  result->noise_floor_rms = std::min(floor.rms, base.fit.rms);
  result->noise_floor_source = floor.source;
  result->ceiling_rms = base.richest_rms;
}

}  // namespace

TraceResult TraceByLikelihood(Design& train, Design& sealed, const actuator::JointModel& model,
                              const TraceOptions& options) {
  const auto progress = [&](const char* what, double share) {
    if (options.progress) options.progress(what, share);
  };
  progress("refit of the declared terms, noise", 0.05);
  const LikelihoodFit base = EstimateLikelihood(&train, model);
  sealed.PredictDrive(base.fit.model);
  progress("columns", 0.4);
  const Problem problem = MakeProblem(train, base.likelihood, model, base.fit);
  progress("sets of effects", 0.5);
  SetJudgement judged = JudgeSets(problem, base.likelihood, train, model,
                                  static_cast<std::size_t>(options.max_rounds),
                                  {.rounds = options.placebo_rounds, .seed = options.seed});

  TraceResult result;
  result.nominal = model;
  result.declared = base.fit.model;
  result.declared_fit = base.fit;
  result.units = static_cast<int>(base.likelihood.used.blocks.size());
  result.unit_kind = "block";
  result.unit_length_s = base.likelihood.used.block_s;
  result.p_global = judged.p_global;
  result.unexplained = judged.unexplained;
  NoteErrors(train, sealed, base, &result);
  Sensitivity sensitivity = FindSensitivity(problem);
  result.not_excited = std::move(sensitivity.not_excited);
  result.judged = std::move(sensitivity.judged);

  progress("confirmation", 0.8);
  Correction correction(train, sealed, base, problem, judged);
  correction.Run(&result);
  RoundReport round;
  round.train_rms = base.fit.rms;
  round.sealed_rms = result.before_sealed.rms;
  round.explainable_rms = base.richest_rms;
  round.scores = std::move(judged.scores);
  result.rounds.push_back(std::move(round));

  result.corrected = correction.corrected().model;
  result.corrected_fit = correction.corrected();
  train.PredictDrive(result.corrected);
  sealed.PredictDrive(result.corrected);
  result.after_train = identify::ErrorOf(train, result.corrected);
  result.after_sealed = identify::ErrorOf(sealed, result.corrected);
  const CandidateSet all = MakeCandidates(train, result.corrected);
  result.shifts = FindShifts(train, model, result.corrected_fit, all.candidates).shifts;
  for (const FoundEffect& found : result.effects) {
    std::erase_if(result.not_excited,
                  [&](const NotExcited& hidden) { return hidden.effect == found.name; });
  }
  result.verdict = !result.effects.empty()                ? Verdict::kEffect
                   : !result.unexplained.variable.empty() ? Verdict::kUnexplained
                                                          : Verdict::kNone;
  return result;
}

}  // namespace sinew::trace

#include "components/model/trace/likelihood_tracer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <set>
#include <string>

#include "components/model/trace/assessment.h"
#include "components/model/trace/facts.h"
#include "components/model/trace/problem.h"
#include "components/model/trace/reported.h"
#include "components/model/trace/rules.h"
#include "components/model/trace/sensitivity.h"
#include "components/model/trace/set_search.h"

namespace sinew::trace {

namespace {

using identify::Design;
using identify::FitResult;

// Every further set that is tried on the held-out recordings is another chance to be confirmed by
// accident.
constexpr int kMostAssessments = 3;

// Searches the sets without the effects of these names.
using AssessBy = std::function<SetAssessment(const std::set<std::string>& refuted)>;

// The effect that training misses least of those that are asked for.
template <class Asked>
std::optional<std::size_t> Weakest(const std::vector<FoundEffect>& found, Asked asked) {
  std::optional<std::size_t> out;
  for (std::size_t k = 0; k < found.size(); ++k) {
    if (!asked(found[k])) continue;
    if (!out || found[k].gain_share < found[*out].gain_share) out = k;
  }
  return out;
}

class Correction {
 public:
  // searched: likelihood and fit of the search; base: the declared terms as reported.
  Correction(Design& train, Design& held_out, const LikelihoodFit& searched,
             const LikelihoodFit& base, const Problem& problem,
             const actuator::JointModel& declared, const TraceOptions& options)
      : train_(train),
        held_out_(held_out),
        whitened_(searched.likelihood),
        searched_(searched.fit),
        base_(base),
        problem_(problem),
        declared_(declared),
        options_(options),
        corrected_(base.fit) {}

  // Fits the set and confirms every member. A member that is wrong spoils the prediction of the
  // others: the refuted one that training misses least leaves, and the rest is confirmed anew. It
  // may have hidden better ones: when none is left, the sets are searched again without
  // those that were refuted.
  void Run(const AssessBy& assess, TraceResult* result) {
    std::set<std::string> refuted;
    for (int round = 0; round < kMostAssessments; ++round) {
      assessed_ = assess(refuted);
      if (round == 0) {
        result->p_global = assessed_.p_global;
        least_statistic_ = assessed_.least_statistic;
        result->scores = assessed_.scores;
      }
      result->unexplained = assessed_.unexplained;
      if (assessed_.chosen.empty()) return;
      Confirm(round > 0, result);
      if (!result->effects.empty()) {
        if (!options_.keep_unconfirmed) LeaveUnconfirmed(result);
        return;
      }
      for (const FoundEffect& found : result->refuted) refuted.insert(found.name);
    }
  }

  // A size behind the other low-pass of the angles is as far from the truth as this one: two errors
  // of one variance differ by twice that variance.
  void WidenIntervals(Design* other, const Likelihood& likelihood) {
    other->UsePredictedRate(whitened_.predicted_rate);
    other->PredictDrive(corrected_.model);
    const double scale = corrected_.balance.Unit(corrected_.coefficients);
    const Eigen::VectorXd rest =
        identify::ErrorOf(*other, corrected_.model).residual(likelihood.used.rows) / scale;
    const FitResult there =
        FitWhitened(*other, Unweighted(likelihood, rest), WithDeclaredValues(corrected_.model));
    for (std::size_t t = 0; t < corrected_.model.terms.size(); ++t) {
      for (std::size_t i = 0; i < corrected_.model.terms[t].linear.size(); ++i) {
        actuator::ParameterValue& here = corrected_.model.terms[t].linear[i];
        if (!here.half_width_95) continue;
        const double apart = here.value - there.model.terms[t].linear[i].value;
        here.half_width_95 = std::hypot(*here.half_width_95, 1.96 / std::numbers::sqrt2 * apart);
      }
    }
  }

  const FitResult& corrected() const { return corrected_; }
  const EffectSet& set() const { return set_; }
  const std::vector<ZeroTurn>& zero_turns() const { return zero_turns_; }
  // Least statistic of the first search, for the limit of p_global.
  double least_statistic() const { return least_statistic_; }

 private:
  // Priors are those of what was declared, not of an earlier fit.
  actuator::JointModel WithDeclaredValues(actuator::JointModel model) const {
    for (std::size_t t = 0; t < declared_.terms.size(); ++t) {
      model.terms[t].linear = declared_.terms[t].linear;
    }
    return model;
  }

  void PredictDrive(const actuator::JointModel& model) {
    train_.PredictDrive(model);
    held_out_.PredictDrive(model);
  }

  // second: another look at the held-out recordings, which may confirm something by accident; what
  // they do not confirm leaves, too.
  void Confirm(bool second, TraceResult* result) {
    second_ = second;
    set_ = assessed_.chosen;
    posteriors_ = assessed_.posteriors;
    while (!set_.empty()) {
      Fit();
      LocateEvent(result);
      std::vector<FoundEffect> found;
      for (std::size_t k = 0; k < set_.members.size(); ++k) found.push_back(Describe(k));
      std::optional<std::size_t> leaves;
      if (!options_.keep_refuted) leaves = RunningAway();
      if (!leaves && !options_.keep_refuted) {
        leaves = Weakest(found, [&](const FoundEffect& effect) {
          return effect.confirmation.verdict == ConfirmationVerdict::kRefuted ||
                 (second && effect.confirmation.verdict != ConfirmationVerdict::kConfirmed);
        });
      }
      if (!leaves) {
        result->effects = std::move(found);
        return;
      }
      found[*leaves].term = -1;
      result->refuted.push_back(std::move(found[*leaves]));
      result->events.clear();
      Leave(*leaves);
    }
  }

  // An effect that the held-out recordings do not confirm is reported, but no part of the model:
  // the weakest leaves, and the others are confirmed anew without it. Its events stay known.
  void LeaveUnconfirmed(TraceResult* result) {
    std::vector<FoundEffect>& found = result->effects;
    while (!found.empty()) {
      const std::optional<std::size_t> leaves = Weakest(found, [](const FoundEffect& effect) {
        return effect.confirmation.verdict != ConfirmationVerdict::kConfirmed;
      });
      if (!leaves) break;
      FoundEffect effect = std::move(found[*leaves]);
      effect.term = -1;
      const bool refuted = effect.confirmation.verdict == ConfirmationVerdict::kRefuted;
      if (effect.score >= options_.in_force.Limit(rules::kOpen)) {
        (refuted ? result->refuted : result->open).push_back(std::move(effect));
      }
      Leave(*leaves);
      found.clear();
      if (!set_.empty()) Fit();
      for (std::size_t k = 0; k < set_.members.size(); ++k) found.push_back(Describe(k));
    }
  }

  double HeldOutError() const {
    return identify::ErrorOf(held_out_, corrected_.model, declared_).rms;
  }

  // The held-out error with an effect over that without it. On a second look also over that as
  // declared: where the refit is worse there, an effect that only undoes this is no finding.
  double Rise(const FoundEffect& found) const {
    double before = found.held_out_before;
    if (second_) before = std::min(before, identify::ErrorOf(held_out_, declared_).rms);
    return found.held_out_after / before;
  }

  // Could the motion have been driven, had the fitted model been true? held_out_error: its own.
  bool Drivable(double held_out_error) const {
    return BeyondDrive() <= options_.in_force.Limit(rules::kBeyondDrive) &&
           std::isfinite(held_out_error);
  }
  double BeyondDrive() const { return std::max(train_.beyond_drive(), held_out_.beyond_drive()); }

  // The first member without which the drive can give what the set asks of it, where it cannot.
  std::optional<std::size_t> RunningAway() {
    if (Drivable(HeldOutError())) return std::nullopt;
    const EffectSet all = set_;
    std::optional<std::size_t> out;
    for (std::size_t k = 0; k < all.members.size() && !out && all.members.size() > 1; ++k) {
      set_ = WithoutMember(problem_.choices(), all, k);
      corrected_ = base_.fit;
      PredictDrive(base_.fit.model);
      Fit();
      if (Drivable(HeldOutError())) out = k;
    }
    set_ = all;
    return out;
  }

  // Takes a member out of the set; the model is that of the declared terms until the next Fit.
  void Leave(std::size_t member) {
    posteriors_.erase(posteriors_.begin() + static_cast<std::ptrdiff_t>(member));
    set_ = WithoutMember(problem_.choices(), set_, member);
    corrected_ = base_.fit;
    PredictDrive(base_.fit.model);
  }

  // Twice: effects that read the drive see the one that the corrected model needs, and priors weigh
  // against the noise that the set leaves, not against the set itself.
  // What is reported is fitted to the plain error.
  void Fit() {
    PredictDrive(searched_.model);
    FindFacts();
    likelihood_ = base_.likelihood;
    actuator::JointModel model = ModelWith(declared_, problem_, set_, &terms_);
    for (int pass = 0; pass < 2; ++pass) {
      corrected_ = RefineWhitened(train_, likelihood_, model);
      likelihood_ = Unweighted(likelihood_, LeftOver(corrected_, likelihood_.used));
      model = WithDeclaredValues(corrected_.model);
      PredictDrive(corrected_.model);
    }
  }

  // The time of an event is no property of the robot: held-out recordings are searched for it with
  // the size that training gave.
  void LocateEvent(TraceResult* result) {
    const std::optional<TimedEffect>& event = base_.likelihood.event;
    if (!event) return;
    const int at = corrected_.model.Find(event->effect->info().name, corrected_.model.balance);
    if (at < 0) return;
    actuator::JointModel without = corrected_.model;
    const double theta = without.terms[static_cast<std::size_t>(at)].linear.front().value;
    without.terms.erase(without.terms.begin() + at);
    const std::vector<std::vector<double>> held_out_start_s =
        LocateTimedEffect(held_out_, *event, theta, identify::ErrorOf(held_out_, without).residual);
    SetClocksBy(*event, held_out_start_s, &held_out_);
    const auto note = [&](const Design& design, const std::vector<std::vector<double>>& start_s,
                          bool held_out) {
      for (std::size_t run = 0; run < start_s.size(); ++run) {
        for (const double start : start_s[run]) {
          result->events.push_back(
              {event->effect->info().name, design.states().run_names[run], held_out, start});
        }
      }
    };
    note(train_, event->start_s, false);
    note(held_out_, held_out_start_s, true);
  }

  FoundEffect Describe(std::size_t k) const {
    FoundEffect found;
    found.name = problem_.hypotheses()[set_.members[k]].name;
    found.balance = corrected_.model.balance;
    found.term = terms_[k].front();
    for (const int term : terms_[k]) {
      found.fitted.push_back(actuator::PhysicalTerm(corrected_.model, term));
    }
    found.posterior = posteriors_[k];
    const double without_it = WithoutMember(problem_.choices(), set_, k).net;
    found.gain_share = (set_.net - without_it) / problem_.evidence.misfit();
    found.p = assessed_.p_global;
    const FitResult without = FitWhitened(train_, likelihood_, Without(corrected_.model, k));
    found.train_before = identify::ErrorOf(train_, without.model, declared_).rms;
    found.train_after = identify::ErrorOf(train_, corrected_.model, declared_).rms;
    found.held_out_before = identify::ErrorOf(held_out_, without.model, declared_).rms;
    found.held_out_after = HeldOutError();
    Facts facts = facts_[k];
    if (problem_.hypotheses()[set_.members[k]].effect->info().event) {
      // It began elsewhere there (LocateEvent).
      facts.SetSlope(ConfirmSlope(held_out_, without, corrected_, options_.in_force));
    }
    Assess(facts, RefusalOf(found, facts, without.model), options_.in_force, &found);
    return found;
  }

  // Facts of every member of the set, by the drive that the declared terms need.
  void FindFacts() {
    facts_.clear();
    zero_turns_.clear();
    for (std::size_t run = 0; run < held_out_.states().run_names.size(); ++run) {
      held_out_.SetMotorTurn(static_cast<int>(run), 0.0);
    }
    for (std::size_t k = 0; k < set_.members.size(); ++k) {
      const std::vector<ZeroTurn> found =
          FindZeroTurns(problem_, set_, k, searched_, whitened_, &held_out_);
      zero_turns_.insert(zero_turns_.end(), found.begin(), found.end());
    }
    const double curve = CurveBeside(problem_, set_);
    for (std::size_t k = 0; k < set_.members.size(); ++k) {
      facts_.push_back(FactsOf(problem_, set_, k, held_out_, searched_, whitened_));
      facts_.back().curve = curve;
    }
  }

  // Refusal of what the drive cannot give, of what raises the held-out error, and of what raises
  // that of everything that the joint is part of, which may lose by what helps the joint alone.
  // without: the model without it.
  std::optional<Refusal> RefusalOf(const FoundEffect& found, const Facts& facts,
                                   const actuator::JointModel& without) const {
    const InForce& in_force = options_.in_force;
    if (!Drivable(found.held_out_after))
      return in_force.RefusedBy(rules::kBeyondDrive, BeyondDrive());
    double rise = Rise(found);
    const double most = in_force.Limit(rules::kRaises);
    const bool named = facts.Score() >= in_force.Limit(rules::kScore);
    if (!(rise > most) && named && options_.held_out_error) {
      rise = options_.held_out_error(corrected_.model) / options_.held_out_error(without);
    }
    if (rise > most) return in_force.RefusedBy(rules::kRaises, rise);
    return std::nullopt;
  }

  // A member's terms taken out, priors of what was declared.
  actuator::JointModel Without(const actuator::JointModel& model, std::size_t k) const {
    actuator::JointModel out = WithDeclaredValues(model);
    for (auto at = terms_[k].rbegin(); at != terms_[k].rend(); ++at) {
      out.terms.erase(out.terms.begin() + *at);
    }
    return out;
  }

  Design& train_;
  Design& held_out_;
  const Likelihood& whitened_;
  const FitResult& searched_;
  bool second_ = false;       // what was found first is refuted
  std::vector<Facts> facts_;  // of the set's members
  std::vector<ZeroTurn> zero_turns_;
  const LikelihoodFit& base_;
  const Problem& problem_;
  SetAssessment assessed_;
  const actuator::JointModel& declared_;  // its drive factor is the unit of errors
  const TraceOptions& options_;
  EffectSet set_;  // what is left of the chosen one
  std::vector<Posterior> posteriors_;
  Likelihood likelihood_;  // of the set's fit
  FitResult corrected_;
  double least_statistic_ = 0.0;
  std::vector<std::vector<int>> terms_;  // of the corrected model, by member
};

}  // namespace

TraceResult TraceByLikelihood(Design& train, Design& held_out, const actuator::JointModel& model,
                              const TraceOptions& options, Design* other_band) {
  const auto progress = [&](const char* what, double share) {
    if (options.progress) options.progress(what, share);
  };
  progress("refit of the declared terms, noise", 0.05);
  const LikelihoodFit base = EstimateLikelihood(&train, model, options.in_force);
  held_out.UsePredictedRate(base.likelihood.predicted_rate);
  held_out.PredictDrive(base.fit.model);
  progress("columns", 0.4);
  Problem problem = MakeProblem(train, base.likelihood, model, base.fit);
  std::optional<Likelihood> other;
  if (other_band != nullptr) other = CompareBands(other_band, model, &problem);
  TraceResult result;
  result.in_force = options.in_force;
  result.nominal = model;
  const LikelihoodFit reported = Reported(train, base, model);
  result.declared = reported.fit.model;
  result.blocks = static_cast<int>(base.likelihood.used.blocks.size());
  result.block_length_s = base.likelihood.used.block_s;
  result.rows = train.rows().size();
  result.used_rows = base.likelihood.used.size();
  if (model.balance == effects::Balance::kMotion) {
    result.row_usage = UsageOf(train, base.likelihood.used);
  }
  NoteErrors(reported, base.fit.model, &train, &held_out, &result);

  progress("sets of effects and their confirmation", 0.5);
  Correction correction(train, held_out, base, reported, problem, model, options);
  const BootstrapOptions bootstrap = BootstrapOf(options);
  correction.Run(
      [&](const std::set<std::string>& refuted) {
        return AssessSets(problem, base.likelihood.used.blocks, model.balance, kLargestSet,
                          bootstrap, refuted, options.agreed);
      },
      &result);
  if (other) correction.WidenIntervals(other_band, *other);
  if (!correction.set().empty()) result.zero_turns = correction.zero_turns();
  result.detectable =
      FindDetectable(problem, model, correction.least_statistic(), correction.set());
  result.corrected = correction.corrected().model;
  train.PredictDrive(result.corrected);
  held_out.PredictDrive(result.corrected);
  result.after_train = identify::ErrorOf(train, result.corrected, model);
  result.after_held_out = identify::ErrorOf(held_out, result.corrected, model);
  const CandidateSet all = MakeCandidates(train, result.corrected, options.in_force);
  result.shifts = FindShifts(train, model, correction.corrected(), all.candidates);
  Conclude(problem, &result);
  return result;
}

}  // namespace sinew::trace

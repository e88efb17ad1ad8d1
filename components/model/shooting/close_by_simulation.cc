#include "components/model/shooting/close_by_simulation.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <stdexcept>
#include <string>

#include "components/model/identify/statistics.h"
#include "components/model/identify/uniform.h"
#include "components/model/shooting/shooting_problem.h"
#include "components/model/trace/assessment.h"
#include "components/model/trace/facts.h"
#include "components/model/trace/problem.h"
#include "components/model/trace/reported.h"
#include "components/model/trace/sensitivity.h"
#include "components/model/trace/set_search.h"

namespace sinew::shooting {

namespace {

using trace::ConfirmationVerdict;
using trace::EffectSet;
using trace::FoundEffect;
using trace::TraceResult;
namespace rules = trace::rules;

constexpr double kInterval = 1.96;
// Every further set that is tried is another chance to be confirmed by accident.
constexpr int kMostSearches = 3;
// Names that are fitted beside the best one, and what they gain at least, share of that.
constexpr std::size_t kMostRivals = 3;
constexpr double kLeastRival = 0.4;

// A model with one more effect, and the numbers of its terms.
struct Corrected {
  Fit fit;
  std::vector<std::vector<int>> terms;
};

class Closer {
 public:
  Closer(const Recordings& train, const Recordings& held_out, const actuator::JointModel& joint,
         const trace::TraceOptions& options)
      : train_(train), held_out_(held_out), joint_(joint), options_(options) {}

  TraceResult Run() {
    Progress("fit of the declared terms by simulation", 0.05);
    out_.by_simulation = true;
    out_.in_force = options_.in_force;
    out_.nominal = joint_;
    fit_ = FitBySimulation(train_, joint_, joint_);
    out_.nominal_train = ErrorOf(train_, joint_);
    out_.nominal_held_out = ErrorOf(held_out_, joint_);
    out_.after_train = out_.before_train = ErrorOf(train_, fit_.model);
    out_.after_held_out = out_.before_held_out = ErrorOf(held_out_, fit_.model);
    out_.noise_floor_rms = held_out_.noise_rad();
    out_.noise_floor_source = "scatter or counts of the angle behind its low-pass";
    out_.rows = out_.used_rows = train_.rows();
    std::set<std::string> refused;
    // One look more than effects, for what is unexplained beside all of them.
    for (int look = 0; look <= static_cast<int>(trace::kLargestSet); ++look) {
      Progress("simulated columns", 0.2 + 0.2 * look);
      if (!Look(look == 0, look < static_cast<int>(trace::kLargestSet), &refused)) break;
    }
    Finish();
    return std::move(out_);
  }

 private:
  void Progress(const char* what, double share) const {
    if (options_.progress) options_.progress(what, share);
  }

  static identify::ModelError ErrorOf(const Recordings& recordings,
                                      const actuator::JointModel& model) {
    identify::ModelError out;
    out.residual = FitStart(recordings, model).residual;
    out.rms = identify::Rms(out.residual);
    const Eigen::VectorXd& q = recordings.measured();
    out.percent = 100.0 * out.rms / std::max(identify::Rms(q.array() - q.mean()), 1e-300);
    return out;
  }

  static void SetHalfWidths(const Regression& regression, const Noise& noise,
                            actuator::JointModel* model) {
    const Eigen::VectorXd deviation = DeviationOf(regression, noise);
    for (std::size_t i = 0; i < regression.parameters.size(); ++i) {
      const Parameter& p = regression.parameters[i];
      actuator::Term& term = model->terms[static_cast<std::size_t>(p.term)];
      const auto k = static_cast<std::size_t>(p.index);
      (p.nonlinear ? term.nonlinear : term.linear)[k].half_width_95 =
          kInterval * deviation[static_cast<Eigen::Index>(i)];
    }
  }

  // The search about the present fit; true: an effect was added to it.
  bool Look(bool first, bool adds, std::set<std::string>* refused) {
    const Regression regression = MakeRegression(
        train_, fit_, FreeParameters(train_, fit_.model, joint_), &options_.in_force);
    Noise noise;
    const trace::Problem problem = ProblemWithNoise(regression, train_, &noise);
    SetHalfWidths(regression, noise, &fit_.model);
    problem_ = &problem;
    if (first) NoteFirst(regression);
    const trace::BootstrapOptions bootstrap = trace::BootstrapOf(options_);
    for (int search = 0; search < kMostSearches; ++search) {
      trace::SetAssessment assessed = trace::AssessSets(problem, regression.blocks, joint_.balance,
                                                        1, bootstrap, *refused, options_.agreed);
      if (first && search == 0) NoteSearch(problem, assessed);
      out_.unexplained = assessed.unexplained;
      if (assessed.chosen.empty() || !adds) return false;
      const Corrected with = Choose(*refused, &assessed);
      if (Add(assessed, with, !first || search > 0)) return true;
      refused->insert(problem.hypotheses()[assessed.chosen.members.front()].name);
    }
    return false;
  }

  void NoteFirst(const Regression& regression) {
    out_.declared = fit_.model;
    out_.blocks = static_cast<int>(regression.blocks.size());
    out_.block_length_s = regression.block_s;
    out_.ceiling_rms = identify::Rms(trace::Richest(*problem_));
  }

  void NoteSearch(const trace::Problem& problem, const trace::SetAssessment& assessed) {
    out_.p_global = assessed.p_global;
    least_statistic_ = assessed.least_statistic;
    out_.scores = assessed.scores;
    out_.detectable = trace::FindDetectable(problem, joint_, least_statistic_, assessed.chosen);
    searched_ = problem;
  }

  // The best setting of each name that gains a good part of what the best one does, that first.
  std::vector<EffectSet> Rivals(const std::set<std::string>& excluded) const {
    std::map<std::string, EffectSet> best;
    for (std::size_t h = 0; h < problem_->hypotheses().size(); ++h) {
      const trace::Hypothesis& hypothesis = problem_->hypotheses()[h];
      if (!hypothesis.physical() || hypothesis.asked != trace::Asked::kSearched ||
          excluded.contains(hypothesis.name)) {
        continue;
      }
      EffectSet set = trace::FitSet(problem_->choices(), {h});
      if (!trace::Physical(problem_->choices(), set)) continue;
      EffectSet& known = best[hypothesis.name];
      if (known.empty() || set.net > known.net) known = std::move(set);
    }
    std::vector<EffectSet> out;
    out.reserve(best.size());
    for (auto& [name, set] : best) out.push_back(std::move(set));
    std::sort(out.begin(), out.end(),
              [](const EffectSet& a, const EffectSet& b) { return a.net > b.net; });
    std::erase_if(out, [&](const EffectSet& set) { return set.net < kLeastRival * out[0].net; });
    if (out.size() > kMostRivals) out.resize(kMostRivals);
    return out;
  }

  Corrected WithSet(const EffectSet& set) const {
    Corrected out;
    out.fit =
        FitBySimulation(train_, trace::ModelWith(fit_.model, *problem_, set, &out.terms), joint_);
    return out;
  }

  // Columns are those about a fit that lacks the effect: the rivals' own fits decide on the name.
  Corrected Choose(const std::set<std::string>& excluded, trace::SetAssessment* assessed) const {
    Progress("fits with an effect", 0.5);
    std::vector<EffectSet> sets = Rivals(excluded);
    if (sets.size() < 2 || options_.agreed) return WithSet(assessed->chosen);
    std::map<std::string, trace::Alternative> possible;
    std::vector<Corrected> fits;
    std::vector<double> gains;
    const double before = fit_.rms * fit_.rms;
    for (const EffectSet& set : sets) {
      fits.push_back(WithSet(set));
      const double rms = fits.back().fit.rms;
      gains.push_back(problem_->evidence.misfit() * std::max(0.0, 1.0 - rms * rms / before));
    }
    const double best = *std::max_element(gains.begin(), gains.end());
    for (std::size_t k = 0; k < sets.size(); ++k) {
      const trace::Hypothesis& h = problem_->hypotheses()[sets[k].members.front()];
      possible[h.name] = {best - gains[k], h.columns.size() + h.effect->info().nonlinear.size()};
    }
    assessed->posteriors = {trace::PosteriorOfNames(best, possible, options_.in_force)};
    const auto named = std::find_if(sets.begin(), sets.end(), [&](const EffectSet& set) {
      return problem_->hypotheses()[set.members.front()].name ==
             assessed->posteriors.front().front().name;
    });
    assessed->chosen = *named;
    return std::move(fits[static_cast<std::size_t>(named - sets.begin())]);
  }

  // Confirms the chosen effect; true: it is in the model now.
  bool Add(const trace::SetAssessment& assessed, const Corrected& with, bool second) {
    Progress("confirmation", 0.6);
    FoundEffect found = Describe(assessed, with.fit, with.terms.front(), second);
    const bool refuted = found.confirmation.verdict == ConfirmationVerdict::kRefuted;
    const bool confirmed = found.confirmation.verdict == ConfirmationVerdict::kConfirmed;
    if (confirmed || (refuted ? options_.keep_refuted : options_.keep_unconfirmed)) {
      fit_ = with.fit;
      out_.after_train = ErrorOf(train_, fit_.model);
      out_.after_held_out = ErrorOf(held_out_, fit_.model);
      out_.effects.push_back(std::move(found));
      return true;
    }
    found.term = -1;
    if (refuted || found.score >= options_.in_force.Limit(rules::kOpen)) {
      (refuted ? out_.refuted : out_.open).push_back(std::move(found));
    }
    return false;
  }

  FoundEffect Describe(const trace::SetAssessment& assessed, const Fit& with,
                       const std::vector<int>& terms, bool second) const {
    const EffectSet& set = assessed.chosen;
    const trace::Hypothesis& h = problem_->hypotheses()[set.members.front()];
    FoundEffect found;
    found.name = h.name;
    found.balance = joint_.balance;
    found.term = terms.front();
    for (const int term : terms) found.fitted.push_back(actuator::PhysicalTerm(with.model, term));
    found.posterior = assessed.posteriors.front();
    found.gain_share = set.net / problem_->evidence.misfit();
    found.p = assessed.p_global;
    found.train_before = out_.after_train.rms;
    found.held_out_before = out_.after_held_out.rms;
    found.train_after = ErrorOf(train_, with.model).rms;
    found.held_out_after = ErrorOf(held_out_, with.model).rms;
    trace::Facts facts;
    facts.curve = trace::CurveBeside(*problem_, set);
    AssessSlope(with.model, &facts);
    trace::Assess(facts, Refuted(found, second), options_.in_force, &found);
    return found;
  }

  // Slope of the held-out rest on what the effect changes there, start states and zeros fitted
  // beside it.
  void AssessSlope(const actuator::JointModel& with, trace::Facts* facts) const {
    const Fit start = FitStart(held_out_, with);
    const Regression there = MakeRegression(held_out_, start, {}, nullptr);
    const Eigen::VectorXd own =
        held_out_.Stacked(with, start.start) - held_out_.Stacked(fit_.model, start.start);
    Eigen::VectorXd rest = there.target;
    // target = own (slope - 1) + what states and zeros take; twice: the noise is what that leaves.
    for (int pass = 0; pass < 2; ++pass) {
      const Noise noise = NoiseOf(there, held_out_, rest, true);
      const trace::Evidence evidence(Whiten(there, noise, there.declared), there.bank.prior,
                                     Whiten(there, noise, own), Eigen::VectorXd::Zero(1),
                                     Whiten(there, noise, there.target).col(0));
      const Eigen::VectorXd more = evidence.Solve({0});
      facts->error = std::sqrt(std::max(0.0, evidence.Covariance({0})(0, 0)));
      if (facts->error > 0.0 && std::isfinite(facts->error)) facts->slope = 1.0 + more[0];
      rest = there.target - own * more - there.declared * evidence.Declared({0}, more);
    }
    facts->blocks = static_cast<int>(there.blocks.size());
  }

  // Refusal of what raises the held-out error; and of a further effect that takes no more of the
  // squared error than the shape of those before it may leave.
  std::optional<trace::Refusal> Refuted(const FoundEffect& found, bool second) const {
    double before = found.held_out_before;
    if (second) before = std::min(before, out_.nominal_held_out.rms);
    const double rise = found.held_out_after / before;
    if (rise > options_.in_force.Limit(rules::kRaises))
      return options_.in_force.RefusedBy(rules::kRaises, rise);
    const auto squares = [](double from, double to) { return from * from - to * to; };
    const double taken = squares(out_.before_train.rms, found.train_before);
    const double share = squares(found.train_before, found.train_after) / taken;
    if (out_.effects.empty() || share > options_.in_force.Limit(rules::kShapeMisfit))
      return std::nullopt;
    return options_.in_force.RefusedBy(rules::kShapeMisfit, share);
  }

  void Finish() {
    out_.corrected = fit_.model;
    for (FoundEffect& found : out_.effects) {
      for (std::size_t k = 0; k < found.fitted.size(); ++k) {
        found.fitted[k] = actuator::PhysicalTerm(out_.corrected, found.term + static_cast<int>(k));
      }
    }
    trace::Conclude(*searched_, &out_);
    NoteShifts();
  }

  // Declared parameters that moved by their tolerance or more.
  void NoteShifts() {
    for (std::size_t t = 0; t < joint_.terms.size(); ++t) {
      const actuator::Term &before = joint_.terms[t], &after = out_.corrected.terms[t];
      for (std::size_t i = 0; i < before.linear.size(); ++i) {
        const double tolerance = actuator::PriorSpread(before.linear[i]);
        const double half = after.linear[i].half_width_95.value_or(0.0);
        const double moved = after.linear[i].value - before.linear[i].value;
        const double unit = std::hypot(tolerance, half / kInterval);
        if (before.linear[i].fixed || !(tolerance > 0.0) || std::abs(moved) < unit) continue;
        out_.shifts.push_back({.effect = before.effect->info().name,
                               .parameter = before.effect->info().linear[i].name,
                               .nominal = before.linear[i].value,
                               .refit = after.linear[i].value,
                               .tolerance = tolerance,
                               .half_width_95 = half,
                               .sigma = moved / unit,
                               .causes = {}});
      }
    }
  }

  const Recordings& train_;
  const Recordings& held_out_;
  const actuator::JointModel& joint_;
  const trace::TraceOptions& options_;
  Fit fit_;                                  // of the model so far
  const trace::Problem* problem_ = nullptr;  // about it
  std::optional<trace::Problem> searched_;   // the first one
  double least_statistic_ = 0.0;
  TraceResult out_;
};

trace::LoopResult TooLittle(trace::LoopResult loop, const actuator::JointModel& joint,
                            trace::TooLittle why) {
  loop.trace.verdict = trace::Verdict::kTooLittleData;
  loop.trace.nominal = loop.trace.declared = loop.trace.corrected = joint;
  loop.trace.by_simulation = true;
  loop.trace.too_little = std::move(why);
  return loop;
}

}  // namespace

trace::LoopResult CloseBySimulation(const std::vector<types::Run>& train,
                                    const std::vector<types::Run>& held_out,
                                    const actuator::JointModel& joint, double longest_gap_s,
                                    const trace::TraceOptions& options,
                                    const free_run::MakeBody& make_body) {
  for (const auto* runs : {&train, &held_out}) {
    for (const types::Run& run : *runs) {
      if (run.held) {
        throw std::invalid_argument(run.name + ": positions that were held, expected a motion");
      }
    }
  }
  trace::LoopResult loop;
  loop.processing = options.processing ? identify::Resolve(*options.processing, train)
                                       : ProcessingOf(train, joint, longest_gap_s);
  try {
    const Recordings trained(train, joint, loop.processing, make_body, options.in_force);
    const Recordings tested(held_out, joint, loop.processing, make_body, options.in_force);
    for (const auto& [recordings, rule] :
         {std::pair{&trained, &rules::kBlocks}, std::pair{&tested, &rules::kHeldOutBlocks}}) {
      const auto pieces = static_cast<double>(recordings->pieces().size());
      if (pieces >= options.in_force.Limit(*rule)) continue;
      return TooLittle(std::move(loop), joint,
                       {.rule = rule->id,
                        .statistic = pieces,
                        .limit = options.in_force.Limit(*rule),
                        .reason = "the recordings have too few pieces to simulate"});
    }
    loop.trace = Closer(trained, tested, joint, options).Run();
    loop.train.emplace(trained.design());
    loop.held_out.emplace(tested.design());
  } catch (const identify::TooLittleData& error) {
    return TooLittle(std::move(loop), joint,
                     {.rule = rules::kRows.id,
                      .limit = options.in_force.Limit(rules::kRows),
                      .reason = error.what()});
  }
  return loop;
}

}  // namespace sinew::shooting

#include "components/model/trace/assessment.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "components/model/identify/statistics.h"
#include "components/model/trace/null_test.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

namespace {

EffectSet Without(const Problem& problem, const EffectSet& set, std::size_t k) {
  return WithoutMember(problem.evidence, problem.hypotheses(), set, k);
}

// Nats a row that a curve gains where something is there that no effect explains.
constexpr double kCurveEvidencePerRow = 0.02;

class Assessor {
 public:
  Assessor(const Problem& problem, const Likelihood& likelihood, const identify::Design& design,
           const actuator::JointModel& declared, const BootstrapOptions& bootstrap,
           const std::set<std::string>& refuted)
      : problem_(problem),
        likelihood_(likelihood),
        design_(design),
        declared_(declared),
        bootstrap_(bootstrap),
        refuted_(refuted),
        misfit_(problem.evidence.misfit()) {}

  SetAssessment Run(std::size_t largest_set) {
    if (problem_.evidence.marginal()) return RunByEvidence(largest_set);
    SetSearch found = SearchSets(problem_.evidence, problem_.hypotheses(), largest_set, refuted_);
    if (found.best.size() > 1 && TooFaint(found.best[1])) {
      found.best = WithoutRates(largest_set).best;
    }
    out_.p_global = std::min(1.0, bootstrap_.searches * GlobalP(found));
    const bool open = out_.p_global <= Limit(rules::kGlobalP);
    if (open) Grow(found);
    if (open) CompareCurves(found);
    if (!out_.chosen.empty()) RequireConstancy();
    RankNames();
    NoteScores(found, open);
    return std::move(out_);
  }

 private:
  double Statistic(double gain, std::size_t hypothesis) const {
    return GainStatistic(gain, problem_.hypotheses()[hypothesis]);
  }

  // Of what is added to `base`; noise: what the best model leaves.
  NullTest Test(const EffectSet& base, const Eigen::VectorXd& noise) const {
    return NullTest(problem_.X, problem_.Z, noise, problem_.evidence, problem_.hypotheses(),
                    base.columns, likelihood_.used.blocks, bootstrap_.rounds, bootstrap_.seed);
  }
  double P(const EffectSet& base, const EffectSet& grown, double statistic) const {
    return Test(base, problem_.Left(grown)).P(statistic);
  }
  // In a short recording a free curve fits what goes on slowly in the noise. What it fits of a
  // block alone is noise.
  double POfCurve(const EffectSet& base, const EffectSet& with, double statistic) const {
    return Test(base, problem_.LeftOut(with, likelihood_.used.blocks)).P(statistic);
  }

  // The set grows while a member adds evidence, and more than the shape of the others may leave.
  SetAssessment RunByEvidence(std::size_t largest_set) {
    const SetSearch found =
        SearchSets(problem_.evidence, problem_.hypotheses(), largest_set, refuted_);
    out_.p_global = std::min(1.0, bootstrap_.searches * GlobalP(found));
    const bool open = out_.p_global <= Limit(rules::kGlobalP);
    for (std::size_t size = 1; open && size < found.best.size(); ++size) {
      const double more = found.best[size].net - out_.chosen.net;
      if (more > Limit(rules::kEvidence) && more > Limit(rules::kShapeMisfit) * out_.chosen.net &&
          EveryMemberCounts(found.best[size])) {
        out_.chosen = found.best[size];
      }
    }
    const EffectSet with = WithBestCurve(problem_.evidence, problem_.hypotheses(), out_.chosen);
    const double rows = static_cast<double>(problem_.y.size());
    if (open && !with.empty() && with.net - out_.chosen.net > 2.0 * kCurveEvidencePerRow * rows) {
      const double statistic = Statistic(with.gain - out_.chosen.gain, with.members.back());
      if (POfCurve(out_.chosen, with, statistic) <= Limit(rules::kMemberP)) NoteUnexplained(with);
    }
    RankNames();
    NoteScores(found, open);
    return std::move(out_);
  }

  // Is each member more than an imperfection that any machine has?
  bool EveryMemberCounts(const EffectSet& set) const {
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const Hypothesis& h = problem_.hypotheses()[set.members[k]];
      const EffectSet without = Without(problem_, set, k);
      if (!Adequate(without, set, LeastShare(h), LeastVariance(h))) return false;
    }
    return true;
  }

  // Of the largest statistic of the whole search, an effect's or a curve's.
  double GlobalP(const SetSearch& found) {
    EffectSet loudest = found.curve;
    const auto statistic = [&](const EffectSet& single) {
      return single.empty() ? -1e300 : Statistic(single.gain, single.members.front());
    };
    for (const EffectSet& single : found.singles) {
      if (statistic(single) > statistic(loudest)) loudest = single;
    }
    if (loudest.empty()) return 1.0;
    const NullTest test = Test({}, problem_.Left(loudest));
    out_.least_statistic = test.Least(Limit(rules::kGlobalP));
    return test.P(statistic(loudest));
  }

  double LeastGain(std::size_t hypothesis) const {
    return misfit_ * LeastShare(problem_.hypotheses()[hypothesis]);
  }

  // One that looks like an error of the low-pass would stand in the way of the others.
  bool TooFaint(const EffectSet& single) const {
    const Hypothesis& h = problem_.hypotheses()[single.members.front()];
    return h.from_rates() && !Adequate({}, single, LeastShare(h), LeastVariance(h));
  }

  // Does it explain so much more, of the misfit or of the variance?
  bool Adequate(const EffectSet& without, const EffectSet& with, double share,
                double variance) const {
    return with.net - without.net > share * misfit_ ||
           problem_.VarianceShare(with) - problem_.VarianceShare(without) > variance;
  }

  SetSearch WithoutRates(std::size_t largest_set) const {
    std::set<std::string> unasked = refuted_;
    for (const Hypothesis& h : problem_.hypotheses()) {
      if (h.from_rates()) unasked.insert(h.name);
    }
    return SearchSets(problem_.evidence, problem_.hypotheses(), largest_set, unasked);
  }

  bool EnoughMore(const EffectSet& without, const EffectSet& with, double share,
                  double variance) const {
    return (with.net - without.net > Limit(rules::kShapeMisfit) * without.net &&
            Adequate(without, with, share, variance)) ||
           Relief(without, with) > Limit(rules::kPriorPenalty);
  }

  EffectSet MostRelief(const SetSearch& found) const {
    EffectSet best;
    for (const EffectSet& single : found.singles) {
      if (Relief({}, single) > std::max(Limit(rules::kPriorPenalty), Relief({}, best)) &&
          EveryMemberIsMissed(single)) {
        best = single;
      }
    }
    return best;
  }

  // An effect that a refit absorbs shows in declared values far outside of their tolerances.
  double Relief(const EffectSet& without, const EffectSet& with) const {
    const double now = problem_.evidence.PriorMisfit(with.columns, with.c);
    const double before = problem_.evidence.PriorMisfit(without.columns, without.c);
    return std::min(before - now, with.net - without.net);
  }

  void Grow(const SetSearch& found) {
    for (std::size_t size = 1; size < found.best.size(); ++size) {
      const EffectSet& grown = found.best[size];
      if (EnoughMore(out_.chosen, grown, Limit(rules::kExplainedShare),
                     Limit(rules::kVarianceShare)) &&
          EveryMemberIsMissed(grown)) {
        out_.chosen = grown;
      } else if (size == 1) {
        out_.chosen = MostRelief(found);
      } else {
        return;  // where no single will do, a pair may
      }
    }
  }

  // By the p of each beside the others. A free curve beside the set takes what goes on beside it
  // out of the noise.
  bool EveryMemberIsMissed(const EffectSet& set) const {
    const EffectSet with = WithBestCurve(problem_.evidence, problem_.hypotheses(), set);
    const EffectSet& richer = with.net > set.net ? with : set;
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const EffectSet without = Without(problem_, set, k);
      const Hypothesis& h = problem_.hypotheses()[set.members[k]];
      if (!EnoughMore(without, set, LeastShare(h), LeastVariance(h))) return false;
      const double statistic = Statistic(set.gain - without.gain, set.members[k]);
      if (P(without, richer, statistic) > Limit(rules::kMemberP)) return false;
    }
    return true;
  }

  void CompareCurves(const SetSearch& found) {
    const EffectSet with = WithBestCurve(problem_.evidence, problem_.hypotheses(), out_.chosen);
    if (with.empty()) return;
    const double more = with.net - out_.chosen.net;
    // Beside a set it has to explain as much as a set has to.
    const Rule& least = out_.chosen.empty() ? rules::kCurveShare : rules::kExplainedShare;
    if (!(more > Limit(least) * misfit_) || !(more > Limit(rules::kClearlyMore) * with.net)) {
      return;
    }
    const double statistic = Statistic(with.gain - out_.chosen.gain, with.members.back());
    if (POfCurve(out_.chosen, with, statistic) > Limit(rules::kMemberP)) return;
    NoteUnexplained(found.curve.net > out_.chosen.net ? found.curve : with);
    if (out_.chosen.empty() || out_.unexplained.variable.empty()) return;
    // Does it explain more than the set, or is the set but a part of the curve?
    std::vector<std::size_t> both = out_.chosen.members;
    both.push_back(found.curve.members.back());
    const EffectSet beside = FitSet(problem_.evidence, problem_.hypotheses(), std::move(both));
    if (more > out_.chosen.net ||
        beside.net - found.curve.net < Limit(rules::kClearlyMore) * out_.chosen.net) {
      Refuse(rules::kClearlyMore, more / with.net);
    }
  }

  void Refuse(const Rule& rule, double value) {
    for (const std::size_t member : out_.chosen.members) {
      refused_[problem_.hypotheses()[member].name] = RefusedBy(rule, value);
    }
    out_.chosen = {};
  }

  // set: its last member is a curve.
  void NoteUnexplained(const EffectSet& set) {
    const Hypothesis& curve = problem_.hypotheses()[set.members.back()];
    const auto first = static_cast<Eigen::Index>(set.columns.size() - curve.columns.size());
    EffectSet own;
    own.columns = curve.columns;
    own.c = set.c.tail(set.c.size() - first);
    Eigen::VectorXd part = problem_.Part(own);
    // What the declared terms would take of it is no part of what is unexplained.
    part = identify::LeftBy(problem_.bank.declared, part);
    const double rms = problem_.scale * identify::Rms(part);
    if (rms < Floor()) return;
    out_.unexplained = {.balance = declared_.balance,
                        .variable = curve.variable,
                        .order_per_turn = curve.order_per_turn,
                        .rms = rms,
                        .share = set.gain / misfit_,
                        .experiment = ""};
  }

  // Encoders and gas are fitted down to their noise, where no machine is as its model says: what
  // stays within the noise of a row has no variable worth a name.
  double Floor() const {
    if (declared_.balance == effects::Balance::kMotion) return 0.0;
    return problem_.scale * identify::Rms(Richest(problem_));
  }

  // The set's contribution times the time in its recording (-1 to 1; none runs between holds), and
  // in each recording alone.
  Eigen::MatrixXd Changing(const Eigen::VectorXd& part) const {
    const identify::Rows& rows = design_.rows();
    const UsedRows& used = likelihood_.used;
    const auto row = [&](Eigen::Index k) { return used.rows[static_cast<std::size_t>(k)]; };
    const auto run = [&](Eigen::Index k) { return rows.run[static_cast<std::size_t>(row(k))]; };
    std::map<int, std::pair<double, double>> span;
    for (Eigen::Index k = 0; k < used.size(); ++k) {
      const double time_s = rows.time_s[row(k)];
      auto [at, fresh] = span.try_emplace(run(k), time_s, time_s);
      at->second.first = std::min(at->second.first, time_s);
      at->second.second = std::max(at->second.second, time_s);
    }
    const auto count = static_cast<Eigen::Index>(span.size());
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(used.size(), 1 + (count > 1 ? count : 0));
    for (Eigen::Index k = 0; k < used.size(); ++k) {
      const auto [first, last] = span.at(run(k));
      const double time_s = rows.time_s[row(k)];
      if (last > first && !design_.held())
        out(k, 0) = part[k] * (2.0 * (time_s - first) / (last - first) - 1.0);
      const auto number = static_cast<Eigen::Index>(std::distance(span.begin(), span.find(run(k))));
      if (count > 1) out(k, 1 + number) = part[k];
    }
    return out;
  }

  // A set whose size changes with time is refused, and the change is what is unexplained.
  void RequireConstancy() {
    const EffectSet& set = out_.chosen;
    const Eigen::MatrixXd changing = Changing(problem_.Part(set));
    const Eigen::MatrixXd z = Whiten(likelihood_, changing);
    const Eigen::Index declared = problem_.X.cols();
    const auto own = static_cast<Eigen::Index>(set.columns.size());
    Eigen::MatrixXd base(problem_.X.rows(), declared + own);
    base << problem_.X, problem_.Z(Eigen::all, set.columns);
    Prior prior = problem_.bank.prior;
    prior.mean.conservativeResize(declared + own);
    prior.precision.conservativeResize(declared + own);
    prior.mean.tail(own).setZero();
    prior.precision.tail(own) = problem_.evidence.precision()(set.columns);
    // A size that changes by as much as itself is plausible.
    const Evidence interaction(base, prior, z, Eigen::VectorXd::Ones(z.cols()), problem_.y);
    Columns all;
    for (Eigen::Index j = 0; j < z.cols(); ++j) all.push_back(j);
    const double net = interaction.Gain(all) - 2.0 * static_cast<double>(z.cols());
    if (net < Limit(rules::kConstancy) * set.net || net < Limit(rules::kExplainedShare) * misfit_) {
      return;
    }
    out_.unexplained = {.balance = declared_.balance,
                        .variable = "time_s",
                        .order_per_turn = 0.0,
                        .rms = problem_.scale * identify::Rms(changing * interaction.Solve(all)),
                        .share = net / misfit_,
                        .experiment = ""};
    Refuse(rules::kConstancy, net / set.net);
  }

  // Shapes and coefficients that the recordings show.
  std::size_t Parameters(const Hypothesis& h) const {
    const auto& columns = h.settings.front().columns;
    const auto shown = std::count_if(columns.begin(), columns.end(), [&](Eigen::Index j) {
      return problem_.evidence.reduced()(j, j) > 0.0;
    });
    return h.effect->info().nonlinear.size() + static_cast<std::size_t>(shown);
  }

  // The set with every name at its best setting in a member's place.
  std::map<std::string, EffectSet> Replace(std::size_t member, const EffectSet& without) const {
    const EffectSet& set = out_.chosen;
    const std::vector<Hypothesis>& hypotheses = problem_.hypotheses();
    std::map<std::string, EffectSet> out;
    for (std::size_t h = 0; h < hypotheses.size(); ++h) {
      const std::string& name = hypotheses[h].name;
      if (!hypotheses[h].physical() || refuted_.contains(name)) continue;
      if (hypotheses[h].asked == Asked::kNoise) continue;
      if (hypotheses[h].asked == Asked::kRival && name == hypotheses[set.members[member]].name) {
        continue;
      }
      std::vector<std::size_t> members = set.members;
      members[member] = h;
      const bool twice = std::count_if(members.begin(), members.end(), [&](std::size_t other) {
                           return hypotheses[other].name == name;
                         }) > 1;
      if (twice && h != set.members[member]) continue;
      EffectSet other = FitSet(problem_.evidence, hypotheses, std::move(members));
      if (h != set.members[member] && !Physical(problem_.evidence, hypotheses, other)) continue;
      const auto at = out.find(name);
      if (at != out.end() && at->second.net >= other.net) continue;
      out[name] = std::move(other);
    }
    std::erase_if(out, [&](const auto& entry) {
      const Hypothesis& h = hypotheses[entry.second.members[member]];
      return h.name != hypotheses[set.members[member]].name && h.from_rates() &&
             !Adequate(without, entry.second, LeastShare(h), LeastVariance(h));
    });
    return out;
  }

  // Of every member; the most probable name takes its place.
  void RankNames() {
    for (std::size_t k = 0; k < out_.chosen.members.size(); ++k) {
      const EffectSet without = Without(problem_, out_.chosen, k);
      std::map<std::string, EffectSet> sets = Replace(k, without);
      std::map<std::string, Alternative> possible;
      std::set<std::string> only_rivals;
      for (const auto& [name, other] : sets) {
        const Hypothesis& h = problem_.hypotheses()[other.members[k]];
        possible[name] = {out_.chosen.net - other.net, Parameters(h)};
        if (h.asked == Asked::kRival) only_rivals.insert(name);
      }
      Posterior posterior = PosteriorOfNames(out_.chosen.net - without.net, possible);
      const auto leads = std::find_if(
          posterior.begin(), posterior.end(),
          [&](const NameProbability& entry) { return !only_rivals.contains(entry.name); });
      std::rotate(posterior.begin(), leads, leads + 1);
      out_.chosen = std::move(sets.at(posterior.front().name));
      out_.posteriors.push_back(std::move(posterior));
    }
  }

  CandidateScore ScoreOf(const EffectSet& single) const {
    const Hypothesis& h = problem_.hypotheses()[single.members.front()];
    CandidateScore score;
    score.name = h.name;
    score.psi = h.settings.front().psi;
    for (const double c : single.c) score.theta.push_back(problem_.scale * c);
    score.statistic = Statistic(single.gain, single.members.front());
    score.gain_share = single.net / misfit_;
    return score;
  }

  void NoteScores(const SetSearch& found, bool open) {
    for (const EffectSet& single : found.singles) {
      CandidateScore score = ScoreOf(single);
      const auto refused = refused_.find(score.name);
      score.accepted = std::any_of(
          out_.chosen.members.begin(), out_.chosen.members.end(),
          [&](std::size_t member) { return problem_.hypotheses()[member].name == score.name; });
      if (!score.accepted) {
        score.refused = !open                       ? RefusedBy(rules::kGlobalP, out_.p_global)
                        : refused != refused_.end() ? refused->second
                                                    : TooLittle(single);
      }
      out_.scores.push_back(std::move(score));
    }
    for (const EffectSet& single : found.out_of_range) {
      out_.scores.push_back(ScoreOf(single));
      out_.scores.back().refused =
          RefusedBy(rules::kRange, TimesOutOfRange(problem_.hypotheses(), single));
    }
  }

  // Why an effect that stands in nobody's way is no member.
  Refusal TooLittle(const EffectSet& single) const {
    const Hypothesis& h = problem_.hypotheses()[single.members.front()];
    if (problem_.evidence.marginal() && single.net <= Limit(rules::kEvidence)) {
      return RefusedBy(rules::kEvidence, single.net);
    }
    if (single.net <= LeastGain(single.members.front())) {
      return RefusedBy(h.from_rates() ? rules::kCurveShare : rules::kExplainedShare,
                       single.net / misfit_);
    }
    // Beside the set, of which it may repeat a part.
    std::vector<std::size_t> both = out_.chosen.members;
    both.push_back(single.members.front());
    const EffectSet beside = FitSet(problem_.evidence, problem_.hypotheses(), std::move(both));
    const double more = beside.net - out_.chosen.net;
    return RefusedBy(rules::kShapeMisfit, out_.chosen.net > 0.0 ? more / out_.chosen.net : 1.0);
  }

  const Problem& problem_;
  const Likelihood& likelihood_;
  const identify::Design& design_;
  const actuator::JointModel& declared_;
  const BootstrapOptions bootstrap_;
  const std::set<std::string>& refuted_;
  const double misfit_;
  std::map<std::string, Refusal> refused_;
  SetAssessment out_;
};

}  // namespace

SetAssessment AssessSets(const Problem& problem, const Likelihood& likelihood,
                         const identify::Design& design, const actuator::JointModel& declared,
                         std::size_t largest_set, const BootstrapOptions& bootstrap,
                         const std::set<std::string>& refuted) {
  return Assessor(problem, likelihood, design, declared, bootstrap, refuted).Run(largest_set);
}

}  // namespace sinew::trace

#include "components/model/trace/assessment.h"

#include <algorithm>
#include <map>

#include "components/model/identify/statistics.h"
#include "components/model/trace/null_test.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

namespace {

class Assessor {
 public:
  Assessor(const Problem& problem, const std::vector<identify::Block>& blocks,
           effects::Balance balance, const BootstrapOptions& bootstrap,
           const std::set<std::string>& refuted)
      : problem_(problem),
        blocks_(blocks),
        balance_(balance),
        bootstrap_(bootstrap),
        refuted_(refuted),
        misfit_(problem.evidence.misfit()) {}

  SetAssessment Run(std::size_t largest_set) {
    const SetSearch found = SearchSets(problem_.choices(), largest_set, refuted_);
    out_.p_global = std::min(1.0, bootstrap_.searches * GlobalP(found));
    const bool open = out_.p_global <= in_force_.Limit(rules::kGlobalP);
    if (open) Grow(found);
    if (open) CompareCurves();
    RankNames();
    NoteScores(found, open);
    return std::move(out_);
  }

 private:
  double Statistic(double gain, std::size_t hypothesis) const {
    return GainStatistic(gain, problem_.hypotheses()[hypothesis]);
  }

  // Null test of what is added to `base`; noise: the residual of the best model.
  NullTest Test(const EffectSet& base, const Eigen::VectorXd& noise) const {
    return NullTest(problem_.X, problem_.Z, noise, problem_.evidence, problem_.hypotheses(),
                    base.columns, blocks_, bootstrap_.rounds, bootstrap_.seed);
  }
  // In a short recording a free curve fits what goes on slowly in the noise. What it fits of a
  // block alone is noise.
  double POfCurve(const EffectSet& base, const EffectSet& with, double statistic) const {
    return Test(base, problem_.LeftOut(with, blocks_)).P(statistic);
  }

  // The set grows while a member adds evidence, and more than the shape of the others may leave.
  void Grow(const SetSearch& found) {
    for (std::size_t size = 1; size < found.best.size(); ++size) {
      const EffectSet& grown = found.best[size];
      const double more = grown.net - out_.chosen.net;
      if (more > in_force_.Limit(rules::kEvidence) &&
          more > in_force_.Limit(rules::kShapeMisfit) * out_.chosen.net &&
          EveryMemberCounts(grown)) {
        out_.chosen = grown;
      }
    }
  }

  void CompareCurves() {
    const EffectSet with = WithBestCurve(problem_.choices(), out_.chosen);
    if (with.empty()) return;
    const double per_row =
        (with.net - out_.chosen.net) / (2.0 * static_cast<double>(problem_.y.size()));
    if (!(per_row > in_force_.Limit(rules::kCurveEvidence))) return;
    const double statistic = Statistic(with.gain - out_.chosen.gain, with.members.back());
    if (POfCurve(out_.chosen, with, statistic) > in_force_.Limit(rules::kGlobalP)) return;
    NoteUnexplained(with);
  }

  // Is each member more than an imperfection that any machine has?
  bool EveryMemberCounts(const EffectSet& set) const {
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const Hypothesis& h = problem_.hypotheses()[set.members[k]];
      const EffectSet without = Without(set, k);
      if (!Adequate(without, set, h)) return false;
    }
    return true;
  }

  // Does it explain so much more, of the misfit, of the variance, or of values that were measured?
  bool Adequate(const EffectSet& without, const EffectSet& with, const Hypothesis& added) const {
    return with.net - without.net > in_force_.Limit(RuleOfShare(added)) * misfit_ ||
           problem_.VarianceShare(with) - problem_.VarianceShare(without) >
               LeastVariance(added, in_force_) ||
           (problem_.plain_precision.size() > 0 &&
            PriorMisfit(without) - PriorMisfit(with) > in_force_.Limit(rules::kPriorPenalty));
  }

  double PriorMisfit(const EffectSet& set) const {
    return problem_.evidence.PriorMisfit(set.columns, set.c);
  }

  EffectSet Without(const EffectSet& set, std::size_t k) const {
    return WithoutMember(problem_.choices(), set, k);
  }

  // The p of the largest statistic of the whole search, an effect's or a curve's.
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
    out_.least_statistic = test.Least(in_force_.Limit(rules::kGlobalP));
    return test.P(statistic(loudest));
  }

  // set: its last member is a curve.
  void NoteUnexplained(const EffectSet& set) {
    const Hypothesis& curve = problem_.hypotheses()[set.members.back()];
    const auto first = static_cast<Eigen::Index>(set.columns.size() - curve.columns.size());
    EffectSet own;
    own.columns = curve.columns;
    own.c = set.c.tail(set.c.size() - first);
    Eigen::VectorXd part = problem_.Part(own);
    // The part that the declared terms would take of it is not unexplained.
    part = problem_.LeftPlain(part);
    const double rms = problem_.scale * identify::Rms(part);
    if (rms < Floor()) return;
    out_.unexplained = {.balance = balance_,
                        .variable = curve.variable,
                        .order_per_turn = curve.order_per_turn,
                        .rms = rms,
                        .share = set.gain / misfit_,
                        .experiment = ""};
  }

  // Encoders and gas are fitted down to their noise, where no machine is as its model says: what
  // stays within the noise of a row has no variable worth a name.
  double Floor() const {
    if (balance_ == effects::Balance::kMotion) return 0.0;
    return problem_.scale * identify::Rms(Richest(problem_));
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
      EffectSet other = FitSet(problem_.choices(), std::move(members));
      if (h != set.members[member] && !Physical(problem_.choices(), other)) continue;
      const auto at = out.find(name);
      if (at != out.end() && at->second.net >= other.net) continue;
      out[name] = std::move(other);
    }
    std::erase_if(out, [&](const auto& entry) {
      const Hypothesis& h = hypotheses[entry.second.members[member]];
      return h.name != hypotheses[set.members[member]].name && h.from_rates() &&
             !Adequate(without, entry.second, h);
    });
    return out;
  }

  // Ranks the names of every member; the most probable one takes its place.
  void RankNames() {
    for (std::size_t k = 0; k < out_.chosen.members.size(); ++k) {
      const EffectSet without = Without(out_.chosen, k);
      std::map<std::string, EffectSet> sets = Replace(k, without);
      std::map<std::string, Alternative> possible;
      std::set<std::string> only_rivals;
      for (const auto& [name, other] : sets) {
        const Hypothesis& h = problem_.hypotheses()[other.members[k]];
        possible[name] = {out_.chosen.net - other.net, Parameters(h)};
        if (h.asked == Asked::kRival) only_rivals.insert(name);
      }
      Posterior posterior = PosteriorOfNames(out_.chosen.net - without.net, possible, in_force_);
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
      score.accepted = std::any_of(
          out_.chosen.members.begin(), out_.chosen.members.end(),
          [&](std::size_t member) { return problem_.hypotheses()[member].name == score.name; });
      if (!score.accepted) {
        score.refused =
            open ? TooLittle(single) : in_force_.RefusedBy(rules::kGlobalP, out_.p_global);
      }
      out_.scores.push_back(std::move(score));
    }
    for (const EffectSet& single : found.out_of_range) {
      out_.scores.push_back(ScoreOf(single));
      out_.scores.back().refused =
          in_force_.RefusedBy(rules::kRange, TimesOutOfRange(problem_.hypotheses(), single));
    }
  }

  // Why an effect that stands in nobody's way is no member.
  Refusal TooLittle(const EffectSet& single) const {
    const Hypothesis& h = problem_.hypotheses()[single.members.front()];
    if (single.net <= in_force_.Limit(rules::kEvidence)) {
      return in_force_.RefusedBy(rules::kEvidence, single.net);
    }
    if (single.net <= in_force_.Limit(RuleOfShare(h)) * misfit_) {
      return in_force_.RefusedBy(RuleOfShare(h), single.net / misfit_);
    }
    // Beside the set, of which it may repeat a part.
    std::vector<std::size_t> both = out_.chosen.members;
    both.push_back(single.members.front());
    const EffectSet beside = FitSet(problem_.choices(), std::move(both));
    const double more = beside.net - out_.chosen.net;
    return in_force_.RefusedBy(rules::kShapeMisfit,
                               out_.chosen.net > 0.0 ? more / out_.chosen.net : 1.0);
  }

  const Problem& problem_;
  const InForce& in_force_ = problem_.in_force();
  const std::vector<identify::Block>& blocks_;
  const effects::Balance balance_;
  const BootstrapOptions bootstrap_;
  const std::set<std::string>& refuted_;
  const double misfit_;
  SetAssessment out_;
};

}  // namespace

SetAssessment AssessSets(const Problem& problem, const std::vector<identify::Block>& blocks,
                         effects::Balance balance, std::size_t largest_set,
                         const BootstrapOptions& bootstrap, const std::set<std::string>& refuted,
                         const std::optional<std::set<std::string>>& agreed) {
  if (!agreed) return Assessor(problem, blocks, balance, bootstrap, refuted).Run(largest_set);
  std::set<std::string> excluded = refuted, asked = *agreed;
  for (const Hypothesis& h : problem.hypotheses()) {
    if (h.physical() && !agreed->contains(h.name)) excluded.insert(h.name);
  }
  for (const std::string& name : refuted) asked.erase(name);
  SetAssessment out = Assessor(problem, blocks, balance, bootstrap, excluded).Run(largest_set);
  out.chosen = FitAgreedSet(problem.choices(), asked);
  out.posteriors.clear();  // the rotations have them
  for (const std::size_t member : out.chosen.members) {
    out.posteriors.push_back({{problem.hypotheses()[member].name, 1.0}});
  }
  return out;
}

}  // namespace sinew::trace

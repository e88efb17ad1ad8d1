#include "components/model/stance_fit/stance_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <map>

#include "components/model/trace/null_test.h"
#include "components/model/trace/rules.h"

namespace sinew::stance_fit {

namespace {

using trace::EffectSet;
using trace::Hypothesis;
using trace::Limit;
namespace rules = trace::rules;

// Sets of effects by the rules of components/model/trace.
class Search {
 public:
  Search(const Regression& regression, const WhitenedProblem& problem, const ChannelNoise& noise,
         const StanceOptions& options, std::set<std::string> refuted)
      : regression_(regression),
        problem_(problem),
        noise_(noise),
        options_(options),
        refuted_(std::move(refuted)),
        misfit_(problem.evidence.misfit()),
        variance_(PlainRest({}).squaredNorm()) {}

  FoundSet Run() {
    const trace::SetSearch found =
        trace::SearchSets(problem_.evidence, hypotheses(), options_.largest_set, refuted_);
    EffectSet loudest = found.curve;
    for (const EffectSet& single : found.singles) {
      if (loudest.empty() || Statistic(single.gain, single) > Statistic(loudest.gain, loudest)) {
        loudest = single;
      }
    }
    if (loudest.empty()) return out_;
    const trace::NullTest test = Test({}, Left(loudest));
    out_.p_global = test.P(Statistic(loudest.gain, loudest));
    out_.least_statistic = test.Least(Limit(rules::kGlobalP));
    if (out_.p_global > Limit(rules::kGlobalP)) return out_;
    Grow(found);
    CompareCurves();
    if (!out_.set.empty() && !Constant()) {
      out_.unexplained = "time_s";
      out_.set = {};
    }
    for (std::size_t k = 0; k < out_.set.members.size(); ++k) NameMember(k);
    return out_;
  }

 private:
  const std::vector<Hypothesis>& hypotheses() const { return regression_.hypotheses; }

  double Statistic(double gain, const EffectSet& set) const {
    return trace::GainStatistic(gain, hypotheses()[set.members.back()]);
  }

  Eigen::VectorXd Left(const EffectSet& set) const {
    return problem_.y - problem_.X * problem_.evidence.Declared(set.columns, set.c) -
           problem_.Z(Eigen::all, set.columns) * set.c;
  }

  trace::NullTest Test(const EffectSet& base, const Eigen::VectorXd& noise) const {
    return {problem_.X,
            problem_.Z,
            noise,
            problem_.evidence,
            hypotheses(),
            base.columns,
            regression_.blocks,
            options_.sign_flip_rounds,
            options_.seed};
  }

  EffectSet Without(const EffectSet& set, std::size_t k) const {
    return trace::WithoutMember(problem_.evidence, hypotheses(), set, k);
  }

  // What a set leaves of the rows as they are, the declared columns refitted within their
  // tolerances.
  Eigen::VectorXd PlainRest(const EffectSet& set) const {
    Eigen::VectorXd rest = regression_.target;
    if (!set.empty()) rest -= regression_.columns(Eigen::all, set.columns) * set.c;
    const Eigen::MatrixXd& X = regression_.declared;
    Eigen::MatrixXd A = X.transpose() * X;
    A.diagonal() += regression_.prior.precision;
    A.diagonal() *= 1.0 + trace::kRidge;
    return rest - X * A.ldlt().solve(X.transpose() * rest);
  }

  double VarianceShare(const EffectSet& set) const {
    return set.empty() || !(variance_ > 0.0) ? 0.0 : 1.0 - PlainRest(set).squaredNorm() / variance_;
  }

  bool EnoughMore(const EffectSet& without, const EffectSet& with) const {
    const double more = with.net - without.net;
    const bool adequate =
        more > Limit(rules::kExplainedShare) * misfit_ ||
        VarianceShare(with) - VarianceShare(without) > Limit(rules::kVarianceShare);
    const double relief = std::min(more, problem_.evidence.PriorMisfit(without.columns, without.c) -
                                             problem_.evidence.PriorMisfit(with.columns, with.c));
    return (adequate && more > Limit(rules::kShapeMisfit) * without.net) ||
           relief > Limit(rules::kPriorPenalty);
  }

  bool EveryMemberIsMissed(const EffectSet& set, std::vector<double>* p) const {
    const EffectSet with = trace::WithBestCurve(problem_.evidence, hypotheses(), set);
    const EffectSet& richer = with.net > set.net ? with : set;
    p->clear();
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const EffectSet without = Without(set, k);
      if (!EnoughMore(without, set)) return false;
      const double statistic =
          trace::GainStatistic(set.gain - without.gain, hypotheses()[set.members[k]]);
      p->push_back(Test(without, Left(richer)).P(statistic));
      if (p->back() > Limit(rules::kMemberP)) return false;
    }
    return true;
  }

  void Grow(const trace::SetSearch& found) {
    for (std::size_t size = 1; size < found.best.size(); ++size) {
      std::vector<double> p;
      if (EnoughMore(out_.set, found.best[size]) && EveryMemberIsMissed(found.best[size], &p)) {
        out_.set = found.best[size];
        out_.p = std::move(p);
      } else if (size > 1) {
        return;  // where no single will do, a pair may
      }
    }
  }

  void CompareCurves() {
    const EffectSet with = trace::WithBestCurve(problem_.evidence, hypotheses(), out_.set);
    if (with.empty()) return;
    const double more = with.net - out_.set.net;
    const trace::Rule& least = out_.set.empty() ? rules::kCurveShare : rules::kExplainedShare;
    if (!(more > Limit(least) * misfit_) || !(more > Limit(rules::kClearlyMore) * with.net)) return;
    const double statistic = Statistic(with.gain - out_.set.gain, with);
    if (Test(out_.set, Left(with)).P(statistic) > Limit(rules::kMemberP)) return;
    out_.unexplained = hypotheses()[with.members.back()].variable;
    if (more > out_.set.net) out_.set = {};
  }

  // The set's size does not change with time.
  bool Constant() const {
    const EffectSet& set = out_.set;
    const Eigen::VectorXd part = regression_.columns(Eigen::all, set.columns) * set.c;
    Eigen::VectorXd changing = part;
    for (Eigen::Index i = 0; i < part.size(); ++i) {
      changing[i] *= regression_.time_s[i / regression_.channels];
    }
    const Eigen::VectorXd z = Whiten(regression_, noise_, changing);
    const auto own = static_cast<Eigen::Index>(set.columns.size());
    const Eigen::Index declared = problem_.X.cols();
    Eigen::MatrixXd base(problem_.X.rows(), declared + own);
    base << problem_.X, problem_.Z(Eigen::all, set.columns);
    trace::Prior prior = regression_.prior;
    prior.mean.conservativeResize(declared + own);
    prior.precision.conservativeResize(declared + own);
    prior.mean.tail(own).setZero();
    prior.precision.tail(own) = problem_.evidence.precision()(set.columns);
    const trace::Evidence interaction(base, prior, z, Eigen::VectorXd::Ones(1), problem_.y);
    const double net = interaction.Gain({0}) - 2.0;
    return net < Limit(rules::kConstancy) * set.net ||
           net < Limit(rules::kExplainedShare) * misfit_;
  }

  // Names in a member's place, each at its best setting; the most probable one takes it.
  void NameMember(std::size_t k) {
    const EffectSet without = Without(out_.set, k);
    std::map<std::string, EffectSet> sets;
    for (std::size_t h = 0; h < hypotheses().size(); ++h) {
      const std::string& name = hypotheses()[h].name;
      if (!hypotheses()[h].physical() || refuted_.contains(name)) continue;
      std::vector<std::size_t> members = out_.set.members;
      members[k] = h;
      const bool twice = std::count_if(members.begin(), members.end(), [&](std::size_t other) {
                           return hypotheses()[other].name == name;
                         }) > 1;
      if (twice) continue;
      EffectSet other = trace::FitSet(problem_.evidence, hypotheses(), std::move(members));
      if (!trace::Physical(problem_.evidence, hypotheses(), other)) continue;
      const auto at = sets.find(name);
      if (at == sets.end() || at->second.net < other.net) sets[name] = std::move(other);
    }
    std::map<std::string, trace::Alternative> possible;
    for (const auto& [name, other] : sets) {
      const Hypothesis& h = hypotheses()[other.members[k]];
      possible[name] = {out_.set.net - other.net, h.columns.size() + h.settings.front().psi.size()};
    }
    out_.posteriors.push_back(trace::PosteriorOfNames(out_.set.net - without.net, possible));
    const auto best = sets.find(out_.posteriors.back().front().name);
    if (best != sets.end()) out_.set = best->second;
  }

  const Regression& regression_;
  const WhitenedProblem& problem_;
  const ChannelNoise& noise_;
  const StanceOptions& options_;
  std::set<std::string> refuted_;
  double misfit_, variance_;
  FoundSet out_;
};

}  // namespace

FoundSet SearchEffects(const Regression& regression, const WhitenedProblem& problem,
                       const ChannelNoise& noise, const StanceOptions& options,
                       std::set<std::string> refuted) {
  return Search(regression, problem, noise, options, std::move(refuted)).Run();
}

}  // namespace sinew::stance_fit

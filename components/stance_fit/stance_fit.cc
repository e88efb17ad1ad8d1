#include "components/stance_fit/stance_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "components/identify/block_regression.h"
#include "components/identify/statistics.h"
#include "components/identify/too_little_data.h"
#include "components/stance_fit/stance_problem.h"
#include "components/trace/null_test.h"
#include "components/trace/rules.h"
#include "components/trace/sensitivity.h"
#include "components/trace/set_search.h"

namespace sinew::stance_fit {

namespace {

using trace::EffectSet;
using trace::Hypothesis;
using trace::Limit;
namespace rules = trace::rules;

// Sets of effects by the rules of components/trace.
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

  struct Found {
    EffectSet set;
    double p_global = 1.0, least_statistic = 0.0;
    std::string unexplained;
    std::vector<double> p;  // of each member
    std::vector<trace::Posterior> posteriors;
  };

  Found Run() {
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
  Found out_;
};

// Declared columns and a set, plain least squares with priors.
struct PlainFit {
  Eigen::VectorXd b;  // declared, then the set's
  Eigen::MatrixXd covariance;
  double quantile = 0.0;

  double HalfWidth(Eigen::Index i) const {
    return quantile * std::sqrt(std::max(0.0, covariance(i, i)));
  }
};

Eigen::MatrixXd WithSet(const Regression& regression, const trace::Columns& columns) {
  Eigen::MatrixXd out(regression.target.size(),
                      regression.declared.cols() + static_cast<Eigen::Index>(columns.size()));
  out << regression.declared, regression.columns(Eigen::all, columns);
  return out;
}

// Channels are in units of the sensors' noise.
PlainFit FitPlain(const Regression& regression, const trace::Columns& columns) {
  const Eigen::MatrixXd W = WithSet(regression, columns);
  Eigen::VectorXd precision(W.cols());
  precision << regression.prior.precision,
      regression.spread(columns).array().square().inverse().matrix();
  std::vector<identify::Moments> blocks;
  Eigen::MatrixXd A = precision.asDiagonal();
  Eigen::VectorXd m = Eigen::VectorXd::Zero(W.cols());
  double rows = 0.0, squares = 0.0;
  for (const identify::Block& block : regression.long_blocks) {
    blocks.push_back(identify::MomentsOf(block, W, regression.target));
    A += blocks.back().G;
    m += blocks.back().m;
  }
  PlainFit out;
  out.b = identify::Solve(A, m);
  Eigen::MatrixXd scores = precision.asDiagonal();
  for (const identify::Moments& block : blocks) {
    const Eigen::VectorXd score = block.m - block.G * out.b;
    scores += score * score.transpose();
    rows += block.rows;
    squares += block.SquaredError(out.b);
  }
  const auto count = static_cast<double>(blocks.size());
  const double few = count > 1.0 ? count / (count - 1.0) : 1.0;
  // Rows whose noise is white are no less certain than that: where blocks are few, their scores may
  // agree by chance.
  const Eigen::MatrixXd white =
      squares / std::max(1.0, rows) * (A - Eigen::MatrixXd(precision.asDiagonal()));
  const Eigen::MatrixXd inverse = identify::Inverse(A);
  out.covariance = inverse * (few * scores) * inverse;
  const Eigen::MatrixXd least =
      inverse * (white + Eigen::MatrixXd(precision.asDiagonal())) * inverse;
  for (Eigen::Index i = 0; i < out.covariance.rows(); ++i) {
    out.covariance(i, i) = std::max(out.covariance(i, i), least(i, i));
  }
  out.quantile = identify::StudentQuantile(0.975, std::max(1.0, count - 1.0));
  return out;
}

PlacedPayload PayloadOf(const PlainFit& fit, Eigen::Index first, const RigidGroup& group) {
  PlacedPayload out;
  out.link_name = group.name;
  out.rigid_with = group.link_names;
  out.mass_kg = fit.b[first];
  out.mass_half_width_95 = fit.HalfWidth(first);
  if (!(out.mass_kg > 0.0)) return out;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const Eigen::Index at = first + 1 + axis;
    const double place = fit.b[at] / out.mass_kg;
    const double variance = (fit.covariance(at, at) - 2.0 * place * fit.covariance(at, first) +
                             place * place * fit.covariance(first, first)) /
                            (out.mass_kg * out.mass_kg);
    out.place_half_width_95[axis] = fit.quantile * std::sqrt(std::max(0.0, variance));
    out.excited[static_cast<std::size_t>(axis)] = out.place_half_width_95[axis] <= kWidestPlace_m;
    if (out.excited[static_cast<std::size_t>(axis)]) out.place_m[axis] = place;
  }
  return out;
}

StanceError ErrorOf(const Regression& regression, const std::vector<StanceRows>& recordings,
                    const PlainFit& fit, const trace::Columns& columns) {
  StanceError out;
  const Eigen::VectorXd rest = regression.target - WithSet(regression, columns) * fit.b;
  out.share = identify::Rms(rest);
  // The three rows that close alone are their own channels' content: M = N' W of them.
  Eigen::Index at = 0;
  double samples = 0.0;
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  for (const StanceRows& rows : recordings) {
    for (Eigen::Index i = 0; i < rows.size(); ++i, at += regression.channels) {
      const Eigen::MatrixXd& project = rows.project[static_cast<std::size_t>(i)];
      const auto left = rest.segment(at, regression.channels);
      for (Eigen::Index k = 0; k < 3; ++k) {  // the first three of the layout's rows
        const auto row = project.col(k);
        squares[k] += std::pow(row.dot(left) / row.squaredNorm(), 2);
      }
      samples += 1.0;
    }
  }
  const Eigen::Vector3d rms = (squares / std::max(1.0, samples)).cwiseSqrt();
  out.moment_x_Nm = rms[0];
  out.moment_y_Nm = rms[1];
  out.force_z_N = rms[2];
  return out;
}

std::string EffectName(const Hypothesis& h) { return h.effect->info().name; }

class Closer {
 public:
  Closer(const StanceModel& model, const StanceOptions& options)
      : model_(model), options_(options) {}

  StanceResult Close(const std::vector<StanceRecording>& train,
                     const std::vector<StanceRecording>& held_out) {
    out_.corrected = model_.robot();
    try {
      layout_ = model_.Layout(train);
    } catch (const identify::TooLittleData& error) {
      return TooLittle(error.what());
    }
    for (const StanceRecording& recording : train) rows_.push_back(model_.Rows(recording, layout_));
    for (const StanceRecording& recording : held_out) {
      held_out_rows_.push_back(model_.Rows(recording, layout_));
    }
    regression_ = MakeRegression(model_, layout_, rows_, options_.tolerances);
    out_.rows = static_cast<std::size_t>(regression_.time_s.size());
    out_.blocks = regression_.blocks.size();
    out_.channels = layout_.channels();
    out_.low_pass_Hz = layout_.processing.front().state_cutoff_Hz;
    if (static_cast<double>(out_.blocks) < Limit(rules::kBlocks)) {
      return TooLittle("the recordings have " + std::to_string(out_.blocks) +
                       " blocks of rows in use, expected " +
                       std::to_string(static_cast<int>(Limit(rules::kBlocks))));
    }
    const int order = LongestOrder(layout_);
    const ChannelNoise noise = EstimateNoise(regression_, options_.largest_set, order);
    const WhitenedProblem problem = MakeWhitened(regression_, noise);
    std::set<std::string> refuted;
    constexpr int kSearches = 3;  // the first, and two without what was dropped or refuted
    for (int search = 0; search < kSearches; ++search) {
      Search::Found found = Search(regression_, problem, noise, options_, refuted).Run();
      if (!out_.p_global) out_.p_global = found.p_global;
      if (search == 0) NoteDetectable(problem, found.least_statistic);
      Describe(problem, found);
      if (DropUncertain(found.set, &refuted)) {
        if (search + 1 == kSearches) Finish({});
        continue;
      }
      if (held_out_rows_.empty() || !Confirm(order, &found.set, &refuted)) {
        Finish(found);
        break;
      }
      if (search + 1 == kSearches) Finish({});
    }
    NoteNotExcited();
    return std::move(out_);
  }

 private:
  StanceResult TooLittle(const std::string& why) {
    out_.verdict = trace::Verdict::kTooLittleData;
    out_.too_little = why;
    return std::move(out_);
  }

  const Hypothesis& Of(const EffectSet& set, std::size_t k) const {
    return regression_.hypotheses[set.members[k]];
  }

  std::string PlaceOf(const Subject& subject) const {
    if (subject.kind == Subject::Kind::kPayload) return layout_.groups[subject.index].name;
    if (subject.kind == Subject::Kind::kJoint) return model_.robot().joints[subject.index].name;
    return "feet";
  }

  void Describe(const WhitenedProblem& problem, const Search::Found& found) {
    out_.effects.clear();
    out_.unexplained = found.unexplained;
    const PlainFit fit = FitPlain(regression_, found.set.columns);
    Eigen::Index at = regression_.declared.cols();
    for (std::size_t k = 0; k < found.set.members.size(); ++k) {
      const Hypothesis& h = Of(found.set, k);
      const Subject& subject = regression_.subjects[found.set.members[k]];
      StanceEffect effect;
      effect.name = EffectName(h);
      effect.place = PlaceOf(subject);
      effect.posterior = found.posteriors[k];
      effect.p = found.p[k];
      const EffectSet without =
          trace::WithoutMember(problem.evidence, regression_.hypotheses, found.set, k);
      effect.gain_share = (found.set.net - without.net) / problem.evidence.misfit();
      if (subject.kind == Subject::Kind::kPayload) {
        effect.payload = PayloadOf(fit, at, layout_.groups[subject.index]);
      } else {
        actuator::Term term =
            actuator::MakeTerm(effect.name, subject.kind == Subject::Kind::kJoint
                                                ? model_.robot().joints[subject.index].constants
                                                : effects::JointConstants{});
        term.declared = false;
        const std::vector<double>& psi = h.settings.front().psi;
        for (std::size_t i = 0; i < psi.size(); ++i) term.nonlinear[i].value = psi[i];
        for (std::size_t i = 0; i < term.linear.size(); ++i) {
          term.linear[i].value = fit.b[at + static_cast<Eigen::Index>(i)];
          term.linear[i].half_width_95 = fit.HalfWidth(at + static_cast<Eigen::Index>(i));
        }
        effect.term = std::move(term);
      }
      at += static_cast<Eigen::Index>(h.columns.size());
      out_.effects.push_back(std::move(effect));
    }
  }

  // Rule interval: what may as well be zero is no correction. True: the search goes on without it.
  bool DropUncertain(const EffectSet& set, std::set<std::string>* refuted) const {
    bool any = false;
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const StanceEffect& effect = out_.effects[k];
      double most = 0.0;
      if (effect.payload) most = effect.payload->mass_kg / effect.payload->mass_half_width_95;
      if (effect.term) {
        for (const actuator::ParameterValue& value : effect.term->linear) {
          most = std::max(most, std::abs(value.value) / value.half_width_95.value_or(HUGE_VAL));
        }
      }
      if (most > Limit(rules::kInterval)) continue;
      refuted->insert(Of(set, k).name);
      any = true;
    }
    return any;
  }

  // Slope of what is left without an effect on what it predicts, of the fitted model: declared
  // values that a refit without the effect would move far beyond their tolerances stay. True: an
  // effect was refuted, and the search goes on without it.
  bool Confirm(int order, EffectSet* set, std::set<std::string>* refuted) {
    const Regression held_out =
        MakeRegression(model_, layout_, held_out_rows_, options_.tolerances);
    if (held_out.hypotheses.size() != regression_.hypotheses.size()) return false;
    const PlainFit with = FitPlain(regression_, set->columns);
    const Eigen::VectorXd rest = held_out.target - WithSet(held_out, set->columns) * with.b;
    const ChannelNoise noise = NoiseOf(held_out, rest, order);
    bool any = false;
    for (std::size_t k = 0; k < set->members.size(); ++k) {
      const trace::Columns& own = Of(*set, k).columns;
      Eigen::Index first = held_out.declared.cols();
      for (std::size_t i = 0; i < k; ++i) {
        first += static_cast<Eigen::Index>(Of(*set, i).columns.size());
      }
      const Eigen::VectorXd part = held_out.columns(Eigen::all, own) *
                                   with.b.segment(first, static_cast<Eigen::Index>(own.size()));
      StanceEffect& effect = out_.effects[k];
      effect.confirmation =
          trace::ConfirmSlope(Whiten(held_out, noise, rest + part).col(0),
                              Whiten(held_out, noise, part).col(0), held_out.blocks);
      if (effect.confirmation.verdict != trace::ConfirmationVerdict::kRefuted) continue;
      refuted->insert(Of(*set, k).name);
      out_.refuted.push_back(effect);
      any = true;
    }
    return any;
  }

  void Finish(const Search::Found& found) {
    EffectSet kept;
    if (found.set.empty()) out_.effects.clear();
    for (std::size_t k = 0; k < found.set.members.size(); ++k) {
      StanceEffect& effect = out_.effects[k];
      const Hypothesis& h = Of(found.set, k);
      effect.in_model = held_out_rows_.empty() ||
                        effect.confirmation.verdict == trace::ConfirmationVerdict::kConfirmed;
      if (!effect.in_model) continue;
      kept.columns.insert(kept.columns.end(), h.columns.begin(), h.columns.end());
      const Subject& subject = regression_.subjects[found.set.members[k]];
      if (effect.payload) out_.payloads.push_back(*effect.payload);
      if (effect.term && subject.kind == Subject::Kind::kJoint) {
        out_.corrected.joints[subject.index].terms.push_back(*effect.term);
      }
    }
    const PlainFit after = FitPlain(regression_, kept.columns);
    PlainFit before;  // as declared
    before.b = Eigen::VectorXd::Zero(regression_.declared.cols());
    for (std::size_t c = 0; c < regression_.parameters.size(); ++c) {
      const Regression::Parameter& which = regression_.parameters[c];
      if (which.joint < 0) continue;
      actuator::ParameterValue& value = out_.corrected.joints[static_cast<std::size_t>(which.joint)]
                                            .terms[static_cast<std::size_t>(which.term)]
                                            .linear[static_cast<std::size_t>(which.linear)];
      value.value += after.b[static_cast<Eigen::Index>(c)];
      value.half_width_95 = after.HalfWidth(static_cast<Eigen::Index>(c));
    }
    out_.train_before = ErrorOf(regression_, rows_, before, {});
    out_.train_after = ErrorOf(regression_, rows_, after, kept.columns);
    if (!held_out_rows_.empty()) {
      const Regression held_out =
          MakeRegression(model_, layout_, held_out_rows_, options_.tolerances);
      out_.held_out_before = ErrorOf(held_out, held_out_rows_, before, {});
      out_.held_out_after = ErrorOf(held_out, held_out_rows_, after, kept.columns);
    }
    if (!out_.effects.empty()) {
      out_.verdict = trace::Verdict::kEffect;
    } else if (!out_.unexplained.empty()) {
      out_.verdict = trace::Verdict::kUnexplained;
    }
  }

  void NoteDetectable(const WhitenedProblem& problem, double statistic) {
    constexpr double kInexact = 1.15;  // as trace/sensitivity.cc
    for (const Hypothesis& h : regression_.hypotheses) {
      if (!h.physical()) continue;
      const Eigen::Index j = h.columns.front();
      const double reduced = problem.evidence.reduced()(j, j);
      if (!(problem.evidence.FreeShare(j) >= Limit(rules::kAbsorbed)) || !(reduced > 0.0)) continue;
      const double needed = trace::NeededGain(h, problem.evidence.misfit(), statistic, HUGE_VAL);
      const double size = kInexact *
                          trace::SizeForPower(needed, static_cast<int>(h.columns.size()), 0.0) /
                          std::sqrt(reduced);
      const auto known =
          std::find_if(out_.detectable.begin(), out_.detectable.end(),
                       [&](const SmallestSize& entry) { return entry.effect == h.name; });
      const std::string parameter =
          effects::ParameterKey(h.effect->info().linear.front(), types::JointKind::kRotary);
      if (known == out_.detectable.end()) {
        out_.detectable.push_back({h.name, parameter, size});
      } else {
        known->size = std::min(known->size, size);
      }
    }
  }

  void NoteNotExcited() {
    for (std::size_t j = 0; j < layout_.moves.size(); ++j) {
      if (layout_.moves[j]) continue;
      out_.not_excited.push_back({"friction of " + model_.robot().joints[j].name,
                                  "the joint stands: friction has any value up to breakaway"});
    }
    for (const StanceEffect& effect : out_.effects) {
      if (!effect.payload) continue;
      static constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
      for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
        if (effect.payload->excited[axis]) continue;
        out_.not_excited.push_back(
            {std::string("place of the payload along ") + kAxes[axis] + " of " + effect.place,
             "its interval is wider than 20 mm: the link hardly turns against gravity"});
      }
    }
  }

  const StanceModel& model_;
  const StanceOptions& options_;
  StanceLayout layout_;
  std::vector<StanceRows> rows_, held_out_rows_;
  Regression regression_;
  StanceResult out_;
};

}  // namespace

StanceResult CloseStance(const StanceModel& model, const std::vector<StanceRecording>& train,
                         const std::vector<StanceRecording>& held_out,
                         const StanceOptions& options) {
  return Closer(model, options).Close(train, held_out);
}

}  // namespace sinew::stance_fit

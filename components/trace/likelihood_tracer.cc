#include "components/trace/likelihood_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "components/identify/statistics.h"
#include "components/trace/ceiling.h"
#include "components/trace/hypotheses.h"
#include "components/trace/null_test.h"
#include "components/trace/set_search.h"
#include "components/trace/shift.h"
#include "components/trace/whitened_fit.h"

namespace sinew::trace {

namespace {

using identify::Design;
using identify::FitResult;
using identify::Rms;

constexpr double kLargestP = 0.01;
// Net gain over the misfit of the refitted model: what a set must explain to be named.
constexpr double kFewestShare = 0.015;
// The same for a free curve, which fits whatever small structure every machine has.
constexpr double kFewestCurveShare = 0.04;
// A further effect must explain more than the approximate shape of the first may leave.
constexpr double kShapeMisfit = 0.10;
// A free curve explains clearly more.
constexpr double kClearlyMore = 0.25;
constexpr double kSameClass = 0.10;
// Part of an effect's gain that a coefficient changing with time may add.
constexpr double kConstancy = 0.15;
constexpr double kHiddenShare = 0.01;
constexpr double kAbsorbed = 1e-3;
constexpr double kOutlier = 6.0;
// Periods of the angles' low-pass over which the noise's scale is taken.
constexpr double kScalePeriods = 3.0;
constexpr int kFewestRowsPerBlock = 20;

double RobustDeviation(const Eigen::VectorXd& x) {
  std::vector<double> sizes(static_cast<std::size_t>(x.size()));
  for (Eigen::Index i = 0; i < x.size(); ++i) sizes[static_cast<std::size_t>(i)] = std::abs(x[i]);
  return sizes.empty() ? 0.0 : identify::Quantile(std::move(sizes), 0.5) / 0.6745;
}

class LikelihoodTracer {
 public:
  LikelihoodTracer(Design& train, Design& sealed, const actuator::JointModel& model,
                   const TraceOptions& options)
      : train_(train), sealed_(sealed), declared_(model), options_(options) {}

  TraceResult Run() {
    Progress("refit of the declared terms", 0.05);
    FitDeclared();
    Progress("noise", 0.2);
    EstimateNoise();
    Progress("sets of effects", 0.5);
    Search();
    Progress("confirmation", 0.8);
    Assemble();
    return std::move(result_);
  }

 private:
  void Progress(const std::string& what, double share) const {
    if (options_.progress) options_.progress(what, share);
  }

  void PredictDrive(const actuator::JointModel& model) {
    train_.PredictDrive(model);
    sealed_.PredictDrive(model);
  }

  void FitDeclared() {
    likelihood_.used = MakeUsedRows(train_, kFewestRowsPerBlock);
    sealed_used_ = MakeUsedRows(sealed_, kFewestRowsPerBlock);
    const Eigen::VectorXd nominal =
        identify::ErrorOf(train_, declared_).residual(likelihood_.used.rows);
    likelihood_.noise = NoiseModel(nominal, likelihood_.used.stretches, 0);
    fit_ = FitWhitened(train_, likelihood_, declared_);
    if (fit_.balance.fits_scale) {
      const double spread = fit_.balance.spread[0];
      const double error = std::sqrt(std::max(0.0, fit_.covariance(0, 0))) /
                           std::abs(fit_.balance.Scale(fit_.coefficients));
      // Without a stated tolerance the known torques alone set the scale: they must show it.
      likelihood_.keep_scale = fit_.coefficients[0] <= 0.0 || (spread == 0.0 && error > 0.05);
      if (likelihood_.keep_scale) fit_ = FitWhitened(train_, likelihood_, declared_);
    }
    PredictDrive(fit_.model);
  }

  // Two passes: the noise of the richest model, then rows far outside of it left out.
  void EstimateNoise() {
    const double rate = train_.states().rate_Hz;
    const int longest = static_cast<int>(std::clamp(
        std::ceil(2.0 * rate / std::max(1e-9, train_.options().state_cutoff_Hz)), 6.0, 40.0));
    const auto window = static_cast<Eigen::Index>(
        std::ceil(kScalePeriods * rate / train_.options().state_cutoff_Hz));
    for (int pass = 0; pass < 2; ++pass) {
      likelihood_.no_nuisance = ImplausibleNuisances(train_, likelihood_, declared_);
      fit_ = FitWhitened(train_, likelihood_, declared_);
      bank_ = MakeBank(train_, likelihood_, declared_, fit_.balance);
      if (pass == 0) SetNoise(Residual(fit_), window, longest, &likelihood_);
      Whiten();
      const Eigen::VectorXd plain = y_ - X_ * DeclaredAlone();
      AddOrders(train_, likelihood_, declared_, fit_.balance, plain, &bank_);
      Whiten();
      const Evidence evidence = MakeEvidence();
      Columns all;
      for (Eigen::Index j = 0; j < bank_.columns.cols(); ++j) all.push_back(j);
      const Eigen::VectorXd c = evidence.Solve(all);
      const Eigen::VectorXd b = evidence.Declared(all, c);
      const Eigen::VectorXd rest = bank_.target - bank_.declared * b - bank_.columns * c;
      result_.ceiling_rms = Scale() * Rms(rest);
      SetNoise(rest, window, longest, &likelihood_);
      if (pass == 0 && declared_.balance == effects::Balance::kMotion) {
        const Eigen::VectorXd e = trace::Whiten(likelihood_, rest);
        const double limit = kOutlier * RobustDeviation(e);
        std::vector<char> marked(likelihood_.used.rows.size(), 0);
        for (Eigen::Index i = 0; i < e.size(); ++i) {
          marked[static_cast<std::size_t>(i)] = std::abs(e[i]) > limit;
        }
        likelihood_.used = Without(train_, likelihood_.used, marked, kFewestRowsPerBlock);
        // Numbered anew: the noise of the rows that stay.
        std::vector<Eigen::Index> kept;
        for (Eigen::Index i = 0; i < e.size(); ++i) {
          if (!marked[static_cast<std::size_t>(i)]) kept.push_back(i);
        }
        const Eigen::VectorXd clean = rest(kept);
        SetNoise(clean, window, longest, &likelihood_);
      }
    }
    likelihood_.no_nuisance.clear();
    likelihood_.no_nuisance = ImplausibleNuisances(train_, likelihood_, declared_);
    fit_ = FitWhitened(train_, likelihood_, declared_);
    PredictDrive(fit_.model);
    bank_ = MakeBank(train_, likelihood_, declared_, fit_.balance);
    Whiten();
    AddOrders(train_, likelihood_, declared_, fit_.balance, y_ - X_ * DeclaredAlone(), &bank_);
    Whiten();
  }

  Eigen::VectorXd Residual(const FitResult& fit) const {
    return (fit.balance.target - fit.balance.columns * fit.coefficients)(likelihood_.used.rows);
  }
  Eigen::VectorXd DeclaredAlone() const {
    return Evidence(X_, bank_.prior, Eigen::MatrixXd(X_.rows(), 0), Eigen::VectorXd(), y_)
        .Declared({}, Eigen::VectorXd());
  }
  double Scale() const {
    return fit_.balance.fits_scale ? fit_.balance.Scale(fit_.coefficients) : 1.0;
  }
  void Whiten() {
    X_ = trace::Whiten(likelihood_, bank_.declared);
    y_ = trace::Whiten(likelihood_, bank_.target);
    Z_ = trace::Whiten(likelihood_, bank_.columns);
  }
  Evidence MakeEvidence() const {
    const Eigen::VectorXd precision =
        (bank_.spread.array() > 0.0).select(bank_.spread.array().square().inverse(), 1e300);
    return Evidence(X_, bank_.prior, Z_, precision, y_);
  }

  // Whitened residual of a set.
  Eigen::VectorXd Left(const Evidence& evidence, const EffectSet& set) const {
    Eigen::VectorXd e = y_ - X_ * evidence.Declared(set.columns, set.c);
    for (std::size_t k = 0; k < set.columns.size(); ++k) {
      e -= Z_.col(set.columns[k]) * set.c[static_cast<Eigen::Index>(k)];
    }
    return e;
  }

  double P(const Evidence& evidence, const EffectSet& base, const EffectSet& grown,
           double statistic) const {
    return NullTest(X_, Z_, Left(evidence, grown), evidence, bank_.hypotheses, base.columns,
                    likelihood_.used.blocks, options_.placebo_rounds, options_.seed)
        .P(statistic);
  }

  double StatisticOf(const EffectSet& base, const EffectSet& grown) const {
    const Hypothesis& last = bank_.hypotheses[grown.members.back()];
    return GainStatistic(grown.gain - base.gain, last);
  }

  void Search() {
    const Evidence evidence = MakeEvidence();
    const double misfit = evidence.misfit();
    const SetSearch found =
        SearchSets(evidence, bank_.hypotheses, static_cast<std::size_t>(options_.max_rounds));
    const EffectSet none;
    // One p-value of the whole search: its largest statistic, physical or not.
    EffectSet loudest = found.curve;
    for (const EffectSet& single : found.singles) {
      if (loudest.empty() || StatisticOf(none, single) > StatisticOf(none, loudest)) {
        loudest = single;
      }
    }
    result_.p_global = 1.0;
    if (!loudest.empty()) {
      result_.p_global = P(evidence, none, loudest, StatisticOf(none, loudest));
    }
    NoteScores(evidence, found, misfit);
    chosen_ = none;
    if (result_.p_global <= kLargestP) {
      for (std::size_t size = 1; size < found.best.size(); ++size) {
        const EffectSet& grown = found.best[size];
        const double more = grown.net - chosen_.net;
        if (!(more > std::max(kFewestShare * misfit, kShapeMisfit * chosen_.net))) {
          // A pair may show what no single does.
          if (size >= 2 || found.best.size() < 3) break;
          continue;
        }
        if (!Necessary(evidence, grown, misfit)) {
          if (size >= 2) break;
          continue;
        }
        chosen_ = grown;
      }
    }
    // Alternatives that need no physics, alone and beside the set.
    const EffectSet with_curve = WithBestCurve(evidence, bank_.hypotheses, chosen_);
    if (result_.p_global <= kLargestP && !with_curve.empty()) {
      const double more = with_curve.net - chosen_.net;
      const bool clear = more > kFewestCurveShare * misfit && more > kClearlyMore * with_curve.net;
      if (clear &&
          P(evidence, chosen_, with_curve, StatisticOf(chosen_, with_curve)) <= kLargestP) {
        Unexplain(evidence, found.curve.net > chosen_.net ? found.curve : with_curve, misfit);
        if (found.curve.net > (1.0 - kShapeMisfit) * chosen_.net) chosen_ = none;
      }
    }
    if (!chosen_.empty() && !Constant(evidence, misfit)) chosen_ = none;
    FindRivals(evidence);
  }

  // Every member is missed by the others, and its interval does not contain zero.
  bool Necessary(const Evidence& evidence, const EffectSet& set, double misfit) const {
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      std::vector<std::size_t> others = set.members;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const EffectSet without = FitSet(evidence, bank_.hypotheses, others);
      const double more = set.net - without.net;
      if (!(more > std::max(kFewestShare * misfit, kShapeMisfit * without.net))) return false;
      EffectSet last_first = set;
      last_first.members = others;
      last_first.members.push_back(set.members[k]);
      if (P(evidence, without, set, StatisticOf(without, last_first)) > kLargestP) return false;
    }
    return true;
  }

  void Unexplain(const Evidence& evidence, const EffectSet& set, double misfit) {
    const Hypothesis* curve = nullptr;
    for (const std::size_t member : set.members) {
      if (!bank_.hypotheses[member].physical()) curve = &bank_.hypotheses[member];
    }
    if (curve == nullptr) return;
    Eigen::VectorXd part = Eigen::VectorXd::Zero(bank_.target.size());
    for (std::size_t k = 0; k < set.columns.size(); ++k) {
      if (std::find(curve->columns.begin(), curve->columns.end(), set.columns[k]) ==
          curve->columns.end()) {
        continue;
      }
      part += bank_.columns.col(set.columns[k]) * set.c[static_cast<Eigen::Index>(k)];
    }
    (void)evidence;
    // What the declared terms would take of it is no part of what is unexplained.
    const Eigen::MatrixXd gram = bank_.declared.transpose() * bank_.declared;
    part -= bank_.declared * identify::Solve(gram, bank_.declared.transpose() * part);
    const double rms = Scale() * Rms(part);
    // What the encoders round away has no variable worth a name.
    const double counts = declared_.constants.encoder_counts_per_turn;
    if (declared_.balance == effects::Balance::kKinematic && counts > 0.0 &&
        rms < 2.0 * std::numbers::pi / counts / std::sqrt(12.0)) {
      return;
    }
    result_.unexplained = {.balance = declared_.balance,
                           .variable = curve->variable,
                           .order_per_turn = curve->order_per_turn,
                           .rms = rms,
                           .share = set.gain / misfit,
                           .experiment = ""};
  }

  // Does the size of the set change as time goes on, or from recording to recording?
  bool Constant(const Evidence& evidence, double misfit) {
    Eigen::VectorXd part = Eigen::VectorXd::Zero(bank_.target.size());
    for (std::size_t k = 0; k < chosen_.columns.size(); ++k) {
      part += bank_.columns.col(chosen_.columns[k]) * chosen_.c[static_cast<Eigen::Index>(k)];
    }
    const identify::Rows& rows = train_.rows();
    const auto run = [&](Eigen::Index k) {
      return rows.run[static_cast<std::size_t>(likelihood_.used.rows[static_cast<std::size_t>(k)])];
    };
    const auto time = [&](Eigen::Index k) {
      return rows.time_s[likelihood_.used.rows[static_cast<std::size_t>(k)]];
    };
    std::map<int, std::pair<double, double>> span;
    for (Eigen::Index k = 0; k < likelihood_.used.size(); ++k) {
      auto [at, fresh] = span.try_emplace(run(k), time(k), time(k));
      at->second.first = std::min(at->second.first, time(k));
      at->second.second = std::max(at->second.second, time(k));
    }
    Eigen::MatrixXd changing =
        Eigen::MatrixXd::Zero(likelihood_.used.size(), 1 + static_cast<Eigen::Index>(span.size()));
    for (Eigen::Index k = 0; k < likelihood_.used.size(); ++k) {
      const auto& [first, last] = span.at(run(k));
      changing(k, 0) =
          last > first ? part[k] * (2.0 * (time(k) - first) / (last - first) - 1.0) : 0.0;
      const auto number = static_cast<Eigen::Index>(std::distance(span.begin(), span.find(run(k))));
      if (span.size() > 1) changing(k, 1 + number) = part[k];
    }
    const Eigen::MatrixXd z = trace::Whiten(likelihood_, changing);
    Eigen::MatrixXd base(X_.rows(), X_.cols() + static_cast<Eigen::Index>(chosen_.columns.size()));
    base << X_, Z_(Eigen::all, chosen_.columns);
    Prior prior = bank_.prior;
    prior.mean.conservativeResize(base.cols());
    prior.precision.conservativeResize(base.cols());
    prior.mean.tail(base.cols() - X_.cols()).setZero();
    for (std::size_t k = 0; k < chosen_.columns.size(); ++k) {
      prior.precision[X_.cols() + static_cast<Eigen::Index>(k)] =
          evidence.precision()[chosen_.columns[k]];
    }
    const Evidence interaction(base, prior, z, Eigen::VectorXd::Constant(z.cols(), 1.0), y_);
    Columns all;
    for (Eigen::Index j = 0; j < z.cols(); ++j) all.push_back(j);
    const double gain = interaction.Gain(all) - 2.0 * static_cast<double>(z.cols());
    if (gain < kConstancy * chosen_.net || gain < kFewestShare * misfit) return true;
    const Eigen::VectorXd c = interaction.Solve(all);
    result_.unexplained = {.balance = declared_.balance,
                           .variable = "time_s",
                           .order_per_turn = 0.0,
                           .rms = Scale() * Rms(changing * c),
                           .share = gain / misfit,
                           .experiment = ""};
    return false;
  }

  // Effects that would do nearly as well in the place of a member.
  void FindRivals(const Evidence& evidence) {
    rivals_.assign(chosen_.members.size(), {});
    for (std::size_t k = 0; k < chosen_.members.size(); ++k) {
      std::vector<std::size_t> others = chosen_.members;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
      const double own = chosen_.net - FitSet(evidence, bank_.hypotheses, others).net;
      std::map<std::string, double> best;
      for (std::size_t h = 0; h < bank_.hypotheses.size(); ++h) {
        const Hypothesis& rival = bank_.hypotheses[h];
        if (!rival.physical() || rival.name == bank_.hypotheses[chosen_.members[k]].name) continue;
        std::vector<std::size_t> members = chosen_.members;
        members[k] = h;
        const EffectSet set = FitSet(evidence, bank_.hypotheses, std::move(members));
        const double short_of = chosen_.net - set.net;
        if (short_of > kSameClass * own || !Physical(evidence, bank_.hypotheses, set)) continue;
        const auto [at, fresh] = best.try_emplace(rival.name, short_of);
        at->second = std::min(at->second, short_of);
      }
      std::vector<std::pair<double, std::string>> sorted;
      for (const auto& [name, short_of] : best) sorted.emplace_back(short_of, name);
      std::sort(sorted.begin(), sorted.end());
      for (const auto& [short_of, name] : sorted) rivals_[k].push_back(name);
    }
  }

  // What the search saw of every effect, and what the recordings could not have shown.
  void NoteScores(const Evidence& evidence, const SetSearch& found, double misfit) {
    RoundReport report;
    report.train_rms = fit_.rms;
    report.explainable_rms = result_.ceiling_rms;
    report.placebo_99 = kFewestShare;
    for (const EffectSet& single : found.singles) {
      const Hypothesis& h = bank_.hypotheses[single.members.front()];
      CandidateScore score;
      score.name = h.name;
      score.psi = h.settings.front().psi;
      for (Eigen::Index i = 0; i < single.c.size(); ++i)
        score.theta.push_back(Scale() * single.c[i]);
      score.gain.sum = single.net;
      score.gain.t = StatisticOf({}, single);
      score.gain_share = single.net / misfit;
      report.scores.push_back(std::move(score));
    }
    result_.rounds.push_back(std::move(report));

    for (const MissingSignals& missing : bank_.missing) {
      result_.not_excited.push_back({missing.effect, "not recorded: " + missing.fields});
    }
    for (const MissingSignals& silent : bank_.silent) {
      result_.not_excited.push_back({silent.effect, silent.fields + " contains only noise"});
    }
    const double target_rms = Rms(bank_.target);
    const double limit = kFewestShare * misfit;
    // Gain that is expected to exceed the limit in 80 % of recordings (noncentral chi-square).
    const double expected = limit + 0.84 * 2.0 * std::sqrt(limit);
    std::map<std::string, double>
        smallest;  // detectable torque, rms, as a share of the measured side
    std::map<std::string, double> free;
    for (const Hypothesis& h : bank_.hypotheses) {
      if (!h.physical() || h.name == "cogging") continue;
      for (const Eigen::Index j : h.columns) {
        const double own = evidence.FreeShare(j);
        double& most = free.try_emplace(h.name, 0.0).first->second;
        most = std::max(most, own);
        const double reduced = evidence.reduced()(j, j);
        const double c = reduced > 0.0 ? std::sqrt(expected / reduced) : 1e300;
        const double share = c * Rms(bank_.columns.col(j)) / std::max(1e-300, target_rms);
        double& least = smallest.try_emplace(h.name, share).first->second;
        least = std::min(least, share);
      }
    }
    for (const auto& [name, share] : smallest) {
      if (free[name] < kAbsorbed) {
        result_.not_excited.push_back(
            {name, "the declared terms carry all of it: only a shift of parameters shows"});
      } else if (share > kHiddenShare) {
        char text[120];
        std::snprintf(text, sizeof text,
                      "up to %.2g %% of the measured side could hide in this motion",
                      100.0 * share);
        result_.not_excited.push_back({name, text});
      } else {
        result_.judged.push_back(name);
      }
    }
    std::sort(result_.not_excited.begin(), result_.not_excited.end(),
              [](const NotExcited& a, const NotExcited& b) { return a.effect < b.effect; });
  }

  actuator::JointModel ModelWith(const EffectSet& set, std::vector<std::vector<int>>* terms) const {
    actuator::JointModel model = fit_.model;
    const double scale = Scale();
    Eigen::Index k = 0;
    for (const std::size_t member : set.members) {
      const Hypothesis& h = bank_.hypotheses[member];
      std::vector<int> mine;
      for (const Setting1& setting : h.settings) {
        actuator::Term term;
        term.effect = h.effect;
        term.declared = false;
        for (std::size_t i = 0; i < setting.columns.size(); ++i, ++k) {
          term.linear.push_back({.value = scale * set.c[k], .half_width_95 = std::nullopt});
        }
        const auto& infos = h.effect->info().nonlinear;
        for (std::size_t i = 0; i < setting.psi.size(); ++i) {
          actuator::ParameterValue value{.value = setting.psi[i], .half_width_95 = std::nullopt};
          value.fixed = infos[i].dimension == effects::Dimension::kNone;  // counts stay whole
          term.nonlinear.push_back(value);
        }
        mine.push_back(static_cast<int>(model.terms.size()));
        model.terms.push_back(std::move(term));
      }
      terms->push_back(std::move(mine));
    }
    return model;
  }

  FitResult FitSetModel(const actuator::JointModel& model) {
    FitResult fit = RefineWhitened(train_, likelihood_, model);
    PredictDrive(fit.model);
    fit = RefineWhitened(train_, likelihood_, fit.model);
    return fit;
  }

  void Assemble() {
    result_.nominal = declared_;
    result_.declared = fit_.model;
    result_.declared_fit = fit_;
    result_.units = static_cast<int>(likelihood_.used.blocks.size());
    result_.unit_kind = "block";
    result_.unit_length_s = likelihood_.used.block_s;
    const NoiseFloor floor = EstimateNoiseFloor(train_, fit_.balance, Scale());
    result_.noise_floor_rms = std::min(floor.rms, fit_.rms);
    result_.noise_floor_source = floor.source;
    result_.nominal_train = identify::ErrorOf(train_, declared_);
    result_.nominal_sealed = identify::ErrorOf(sealed_, declared_);
    result_.before_train = identify::ErrorOf(train_, fit_.model);
    result_.before_sealed = identify::ErrorOf(sealed_, fit_.model);

    std::vector<std::vector<int>> terms;
    FitResult corrected = fit_;
    if (!chosen_.empty()) {
      corrected = FitSetModel(ModelWith(chosen_, &terms));
      for (std::size_t k = 0; k < chosen_.members.size(); ++k) {
        FoundEffect found = Describe(k, corrected, terms);
        result_.effects.push_back(std::move(found));
      }
      // Refuted effects leave the model; the rest is fitted again.
      EffectSet kept = chosen_;
      kept.members.clear();
      std::vector<FoundEffect> stay;
      for (std::size_t k = 0; k < result_.effects.size(); ++k) {
        FoundEffect& effect = result_.effects[k];
        if (effect.confirmation.verdict == ConfirmationVerdict::kRefuted) {
          effect.term = -1;
          result_.refuted.push_back(std::move(effect));
        } else {
          kept.members.push_back(chosen_.members[k]);
          stay.push_back(std::move(effect));
        }
      }
      result_.effects = std::move(stay);
      if (!result_.refuted.empty()) {
        const Evidence evidence = MakeEvidence();
        kept = FitSet(evidence, bank_.hypotheses, kept.members);
        terms.clear();
        PredictDrive(fit_.model);
        corrected = kept.empty() ? fit_ : FitSetModel(ModelWith(kept, &terms));
        for (std::size_t k = 0; k < result_.effects.size(); ++k) {
          result_.effects[k].term = terms[k].front();
        }
      }
    }
    result_.corrected = corrected.model;
    result_.corrected_fit = corrected;
    PredictDrive(corrected.model);
    result_.after_train = identify::ErrorOf(train_, corrected.model);
    result_.after_sealed = identify::ErrorOf(sealed_, corrected.model);
    const CandidateSet all = MakeCandidates(train_, corrected.model);
    result_.shifts = FindShifts(train_, declared_, corrected, all.candidates).shifts;
    for (const FoundEffect& found : result_.effects) {
      std::erase_if(result_.not_excited,
                    [&](const NotExcited& hidden) { return hidden.effect == found.name; });
    }
    result_.verdict = !result_.effects.empty()                ? Verdict::kEffect
                      : !result_.unexplained.variable.empty() ? Verdict::kUnexplained
                                                              : Verdict::kNone;
  }

  // The held-out rows with the noise that the model leaves there.
  Likelihood HeldOut(const FitResult& with) const {
    Likelihood out;
    out.used = sealed_used_;
    const identify::Balance balance = identify::MakeBalance(sealed_, with.model, with.keep_scale);
    const Eigen::VectorXd rest =
        (balance.target - balance.columns * with.coefficients)(sealed_used_.rows);
    const double rate = sealed_.states().rate_Hz;
    SetNoise(rest,
             static_cast<Eigen::Index>(
                 std::ceil(kScalePeriods * rate / sealed_.options().state_cutoff_Hz)),
             likelihood_.noise.order(), &out);
    return out;
  }

  FoundEffect Describe(std::size_t k, const FitResult& with,
                       const std::vector<std::vector<int>>& terms) {
    const Hypothesis& h = bank_.hypotheses[chosen_.members[k]];
    FoundEffect found;
    found.name = h.name;
    found.balance = declared_.balance;
    found.term = terms[k].front();
    found.rivals = rivals_[k];
    found.gain_share = result_.unexplained.share;
    found.p = result_.p_global;
    found.weak_evidence = likelihood_.used.blocks.size() < 6;
    actuator::JointModel without_model = with.model;
    for (auto at = terms[k].rbegin(); at != terms[k].rend(); ++at) {
      without_model.terms.erase(without_model.terms.begin() + *at);
    }
    PredictDrive(with.model);
    const FitResult without = FitWhitened(train_, likelihood_, without_model);
    found.train_before = without.rms;
    found.train_after = with.rms;
    found.sealed_before = identify::ErrorOf(sealed_, without.model).rms;
    found.sealed_after = identify::ErrorOf(sealed_, with.model).rms;
    found.confirmation = Confirm(sealed_, HeldOut(with), without, with);
    return found;
  }

  Design& train_;
  Design& sealed_;
  const actuator::JointModel& declared_;
  const TraceOptions& options_;
  TraceResult result_;
  Likelihood likelihood_;
  UsedRows sealed_used_;
  FitResult fit_;  // of the declared terms
  Bank bank_;
  Eigen::MatrixXd X_, Z_;
  Eigen::VectorXd y_;
  EffectSet chosen_;
  std::vector<std::vector<std::string>> rivals_;
};

}  // namespace

TraceResult TraceByLikelihood(Design& train, Design& sealed, const actuator::JointModel& model,
                              const TraceOptions& options) {
  return LikelihoodTracer(train, sealed, model, options).Run();
}

}  // namespace sinew::trace

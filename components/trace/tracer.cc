#include "components/trace/tracer.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <random>

#include "components/identify/gas.h"
#include "components/identify/statistics.h"
#include "components/trace/candidates.h"
#include "components/trace/ceiling.h"
#include "components/trace/events.h"
#include "components/trace/shift.h"
#include "components/trace/units.h"
#include "components/trace/variables.h"

namespace sinew::trace {

namespace {

using identify::Balance;
using identify::Block;
using identify::Design;
using identify::FitResult;

constexpr int kFlexibleColumns = 120;
// Two candidates whose fitted parts, freed of the other terms, correlate above this are one class.
constexpr double kSameClass = 0.9;
// Look-alikes that gain less than this share of what the chosen one gains are no rivals.
constexpr double kSameGain = 0.85;
// A declared basic (offset, inertia) that is the chosen effect under another name.
constexpr double kTwin = 0.9999;
// An effect that could hide this share of the drive torque without being seen is "not excited".
constexpr double kHiddenShare = 0.01;
// Less of a candidate's power than this beside all declared terms: a refit swallows it.
constexpr double kSwallowed = 1e-3;
// Less than this beside one declared term alone: it is that term seen from another side.
constexpr double kVariant = 0.02;
constexpr int kMostOrders = 8;  // of one periodic effect beyond its first
// Less than this above the noise floor is not worth a variable's name.
constexpr double kLoudRest = 0.4;
// A variable has to predict this share of what remains to be named.
constexpr double kNamedShare = 0.24;
constexpr double kConvincingUnits = 6;
// An effect whose size is so many standard errors (every unit left out once) is believed though the
// units differ much in what they gain by it.
constexpr double kClearSize = 6.0;
constexpr double kSureSize = 8.0;  // the same for taking it out of the placebo's noise
constexpr std::size_t kFewestToJackknife = 10, kFewestWindowsToJackknife = 5;
constexpr double kClearCurve = 5.0;  // the same for the curve over a variable
// A level that carries this share of a residual this many times the noise's power wanders.
constexpr double kWanders = 0.8, kFarAbove = 25.0;
// Standard errors by which a quarter of the data must ask for the opposite to contradict.
constexpr double kContradicts = 3.0;
// A quarter that holds less of a candidate's power than this tells its noise.
constexpr double kSilent = 1e-3;
constexpr double kShortestDelay = 0.085;  // of a sample
// Counts of the encoder over which friction may build up without being an effect.
constexpr double kFewCounts = 8.0;
constexpr double kTwoPi = 6.283185307179586;

double SumSquares(const Eigen::VectorXd& x, const std::vector<Eigen::Index>& rows) {
  double sum = 0.0;
  for (const Eigen::Index i : rows) sum += x[i] * x[i];
  return sum;
}

int Folds(std::size_t blocks) { return static_cast<int>(std::min<std::size_t>(10, blocks)); }

// A candidate beside the present model.
struct Trial {
  const Candidate* candidate = nullptr;
  std::vector<Setting> settings;
  Eigen::VectorXd gains;         // per block
  std::size_t best = 0;          // setting with the least error on everything
  Eigen::VectorXd coefficients;  // of that setting: base, then extra
  Eigen::VectorXd part;          // what it contributes, freed of the base, used rows
  CandidateScore score;
  double detectable = 0.0;  // torque share that could hide
  bool hidden = false;      // the declared terms carry it
  // Squared shifts of the declared parameters from their nominal values, in tolerances, when it is
  // fitted beside them.
  double surprise = 0.0;
};

bool LookAlike(const effects::EffectInfo& a, const effects::EffectInfo& b) {
  const auto lists = [](const effects::EffectInfo& info, const std::string& name) {
    return std::find(info.look_alikes.begin(), info.look_alikes.end(), name) !=
           info.look_alikes.end();
  };
  return lists(a, b.name) || lists(b, a.name);
}

// One order of several that a motor's turn may hold.
bool IsPeriodic(const effects::Effect& effect) {
  const auto& nonlinear = effect.info().nonlinear;
  return nonlinear.size() == 1 && nonlinear.front().name == "order";
}

class Tracer {
 public:
  Tracer(Design& train, Design& sealed, const actuator::JointModel& model,
         const TraceOptions& options)
      : train_(train), sealed_(sealed), declared_(model), options_(options) {}

  TraceResult Run() {
    Progress("refit of the declared terms", 0.02);
    Prepare();
    FitResult fit = result_.declared_fit;
    actuator::JointModel model = fit.model;
    // Another order of an effect that is there already (cogging has several) is no round of its
    // own.
    for (int round = 0, again = 0; round < options_.max_rounds && again < kMostOrders;) {
      Progress("round " + std::to_string(round + 1) + ": candidates",
               0.1 + 0.25 * static_cast<double>(round));
      if (!Round(&model, &fit)) break;
      const auto same = [&](const FoundEffect& effect) {
        return effect.name == result_.effects.back().name;
      };
      const bool order = std::count_if(result_.effects.begin(), result_.effects.end(), same) > 1 &&
                         IsPeriodic(*model.terms.back().effect);
      ++(order ? again : round);
    }
    TryToRemove(&model, &fit);
    result_.corrected = fit.model;
    result_.corrected_fit = fit;
    if (options_.only.empty()) {
      Progress("what a refit swallowed", 0.86);
      FindSwallowed(&fit);
    }
    // Errors are those of the fits, before and after alike.
    const actuator::JointModel free = result_.corrected;
    PredictDrive(free);
    result_.after_train = identify::ErrorOf(train_, free);
    result_.after_sealed = identify::ErrorOf(sealed_, free);
    // What is written has to be simulated too and stays within the physical range. The second time
    // with the drive that the model inside the range needs.
    for (int pass = 0; pass < 2; ++pass) {
      result_.corrected = identify::WithinPhysicalRange(train_, free, units_.blocks);
      PredictDrive(result_.corrected);
    }
    if (options_.only.empty()) {
      Progress("what stays unexplained", 0.9);
      FindUnexplained(fit);
    }
    for (const FoundEffect& found : result_.effects) {
      std::erase_if(result_.not_excited,
                    [&](const NotExcited& hidden) { return hidden.effect == found.name; });
    }
    result_.verdict = !result_.effects.empty()                ? Verdict::kEffect
                      : !result_.unexplained.variable.empty() ? Verdict::kUnexplained
                                                              : Verdict::kNone;
    Progress("done", 1.0);
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

  void Prepare() {
    used_ = train_.rows().UsedRows();
    rounding_.resize(train_.rows().size(), 0);
    // First blocks from the filter alone, for the intervals of the first fit.
    const double filter_time_s = 1.0 / train_.options().parallel_cutoff_Hz;
    const int parameters =
        static_cast<int>(identify::MakeBalance(train_, declared_).columns.cols());
    const int fewest_rows = std::max(8, parameters / 2);
    units_ = ChooseUnits(train_, filter_time_s, fewest_rows);
    FitResult fit = identify::FitModel(train_, declared_, units_.blocks);
    PredictDrive(fit.model);

    // The noise's own correlation time: of what a flexible model leaves.
    const Eigen::MatrixXd flexible = FlexibleColumns(train_, kFlexibleColumns, options_.seed);
    const Eigen::VectorXd target = fit.balance.target - fit.balance.columns * fit.coefficients;
    FlexibleFit ceiling =
        FitFlexible(units_.blocks, WithBestCandidate(fit, WithLastingEvent(fit, target), target),
                    flexible, target, Folds(units_.blocks.size()));
    const int last_lag = static_cast<int>(std::min<double>(
        20.0 * train_.rows_per_s(), static_cast<double>(train_.rows().size()) / 4.0));
    const Eigen::VectorXd rho = identify::Autocorrelation(
        ceiling.remainder, train_.rows().used, train_.rows().segment, std::max(1, last_lag));
    result_.correlation_time_s = identify::CorrelationTime(rho) / train_.rows_per_s();
    units_ = ChooseUnits(train_, result_.correlation_time_s, fewest_rows);
    fit = identify::FitModel(train_, declared_, units_.blocks);
    ceiling = FitFlexible(units_.blocks, fit.balance.columns, flexible,
                          fit.balance.target - fit.balance.columns * fit.coefficients,
                          Folds(units_.blocks.size()));

    result_.nominal = declared_;
    result_.declared = identify::WithinPhysicalRange(train_, fit.model, units_.blocks);
    result_.declared_fit = fit;
    result_.units = static_cast<int>(units_.blocks.size());
    result_.unit_kind = units_.kind;
    result_.unit_length_s = units_.length_s;
    const double factor = fit.balance.Scale(fit.coefficients);
    const NoiseFloor floor = EstimateNoiseFloor(train_, fit.balance, factor);
    result_.noise_floor_rms = std::min(floor.rms, fit.rms);
    result_.noise_floor_source = floor.source;
    if (floor.rms == 0.0 && declared_.balance == effects::Balance::kKinematic) {
      result_.noise_floor_rms = std::min(EncoderRounding_rad(), fit.rms);
      result_.noise_floor_source = "encoder's rounding";
    }
    result_.ceiling_rms = fit.rms * std::sqrt(std::max(0.0, 1.0 - ceiling.left_out_share));
    result_.nominal_train = identify::ErrorOf(train_, declared_);
    result_.nominal_sealed = identify::ErrorOf(sealed_, declared_);
    result_.before_train = identify::ErrorOf(train_, fit.model);
    result_.before_sealed = identify::ErrorOf(sealed_, fit.model);
  }

  // The columns of a fit, and that of a lasting event whose instant stands out: what goes on after
  // it would be taken for noise that is correlated over minutes.
  Eigen::MatrixXd WithLastingEvent(const FitResult& fit, const Eigen::VectorXd& target) {
    Eigen::MatrixXd columns = fit.balance.columns;
    if (declared_.balance != effects::Balance::kMotion) return columns;
    for (const Candidate& candidate : EventCandidates(declared_)) {
      if (candidate.effect->info().nonlinear.size() > 1) continue;
      const Event event = FindEvent(train_, candidate.effect, units_.blocks, columns, target,
                                    options_.placebo_rounds, options_.seed);
      if (!event.significant) continue;
      SetClocks(event.start_s, event.clock_s, &train_);
      const Eigen::MatrixXd extra =
          train_.Columns(*candidate.effect, std::vector<double>{event.clock_s});
      columns.conservativeResize(Eigen::NoChange, columns.cols() + extra.cols());
      columns.rightCols(extra.cols()) = -extra;
    }
    return columns;
  }

  // The same for what one candidate explains, and the flexible model cannot: memory, rates, orders.
  Eigen::MatrixXd WithBestCandidate(const FitResult& fit, const Eigen::MatrixXd& base,
                                    const Eigen::VectorXd& target) {
    const CandidateSet set = MakeCandidates(train_, fit.model);
    const Eigen::MatrixXd used = base(used_, Eigen::all);
    const Eigen::MatrixXd inverse = identify::Inverse(used.transpose() * used);
    Eigen::VectorXd y = target(used_);
    y -= used * (inverse * (used.transpose() * y));
    double most = 0.05 * y.squaredNorm();
    const Eigen::MatrixXd* best = nullptr;
    for (const Candidate& candidate : set.candidates) {
      for (const GridPoint& point : candidate.grid) {
        const Eigen::MatrixXd z = point.columns(used_, Eigen::all);
        const Eigen::MatrixXd free = z - used * (inverse * (used.transpose() * z));
        if (!(free.squaredNorm() > kSwallowed * z.squaredNorm())) continue;
        const Eigen::VectorXd b = identify::Solve(free.transpose() * free, free.transpose() * y);
        const double explained = b.dot(free.transpose() * y);
        if (!(explained > most)) continue;
        most = explained;
        best = &point.columns;
      }
    }
    if (best == nullptr) return base;
    Eigen::MatrixXd out(base.rows(), base.cols() + best->cols());
    out << base, *best;
    return out;
  }

  std::vector<Trial> Score(const FitResult& fit, const CandidateSet& set, RoundReport* report) {
    const std::vector<Block>& blocks = units_.blocks;
    const int folds = Folds(blocks.size());
    const Balance& balance = fit.balance;
    const double scale = balance.fits_scale ? balance.Scale(fit.coefficients) : 1.0;
    const Eigen::VectorXd target = balance.target - balance.columns * fit.coefficients;
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(blocks.size()));
    const std::vector<Setting> base = {
        Setting(blocks, balance.columns, Eigen::MatrixXd(target.size(), 0), target, folds)};
    const Eigen::VectorXd base_errors = LeftOutErrors(base, ones, folds);
    const double base_sum = base_errors.sum();
    double rows = 0.0;
    for (const Block& block : blocks) rows += static_cast<double>(block.size());
    const double variance = scale * scale * base_sum / rows;
    const double floor = result_.noise_floor_rms * result_.noise_floor_rms;
    const double explainable = std::max(variance - floor, 0.02 * variance);
    report->explainable_rms = std::sqrt(explainable);

    const Eigen::MatrixXd base_used = balance.columns(used_, Eigen::all);
    const Eigen::MatrixXd base_gram = base_used.transpose() * base_used;
    // What could hide is told beside the size of the measured side: its largest value where its
    // level means nothing.
    const double drive_rms =
        std::abs(balance.Scale(fit.coefficients)) *
        (train_.rows().window.empty() ? std::sqrt(SumSquares(balance.drive_torque, used_) /
                                                  static_cast<double>(used_.size()))
                                      : balance.drive_torque(used_).cwiseAbs().maxCoeff());
    const double drive_share = actuator::DriveShare(fit.model, fit.model.balance);
    std::vector<Trial> trials;
    for (const Candidate& candidate : set.candidates) {
      Trial trial;
      trial.candidate = &candidate;
      double least = std::numeric_limits<double>::infinity();
      trial.detectable = std::numeric_limits<double>::infinity();
      double visible_best = 0.0;
      for (const GridPoint& point : candidate.grid) {
        trial.settings.emplace_back(blocks, balance.columns, -point.columns, target, folds);
        const Eigen::VectorXd b = trial.settings.back().Coefficients();
        const double error = trial.settings.back().SquaredError(b);
        const Eigen::MatrixXd z = point.columns(used_, Eigen::all);
        const Eigen::MatrixXd free =
            z - base_used * identify::Inverse(base_gram) * (base_used.transpose() * z);
        const double power = z.squaredNorm();
        const double visible = power > 0.0 ? free.squaredNorm() / power : 0.0;
        visible_best = std::max(visible_best, visible);
        // Torque that could hide: three standard errors of the parameters times the largest
        // regressor.
        if (power > 0.0 && visible > 1e-9) {
          const Eigen::MatrixXd covariance =
              identify::BlockCovariance(trial.settings.back().blocks(), b);
          double hidden = 0.0;
          for (Eigen::Index c = 0; c < z.cols(); ++c) {
            const Eigen::Index at = balance.columns.cols() + c;
            hidden = std::max(hidden, 3.0 * std::sqrt(std::max(0.0, covariance(at, at))) *
                                          z.col(c).cwiseAbs().maxCoeff() * scale);
          }
          trial.detectable = std::min(trial.detectable, hidden / std::max(drive_rms, 1e-300));
        }
        if (error < least) {
          least = error;
          trial.best = trial.settings.size() - 1;
          trial.coefficients = b;
          trial.part = free * b.tail(z.cols());
          trial.score.visible_share = visible;
        }
      }
      // A look-alike of a declared term in other clothes: nothing but that term's own flaws shows.
      double beside_one = 1.0;
      if (candidate.grid.size() == 1 && candidate.grid.front().columns.cols() == 1) {
        const Eigen::VectorXd z = candidate.grid.front().columns(used_, 0);
        const Eigen::Index first = balance.fits_scale ? 1 : 0;
        for (Eigen::Index c = first; c < base_used.cols(); ++c) {
          const auto term = static_cast<std::size_t>(
              balance.parameters[static_cast<std::size_t>(c - first)].term);
          if (!LookAlike(candidate.effect->info(), fit.model.terms[term].effect->info())) continue;
          const double power = z.squaredNorm() * base_used.col(c).squaredNorm();
          const double dot = z.dot(base_used.col(c));
          if (power > 0.0) beside_one = std::min(beside_one, 1.0 - dot * dot / power);
        }
      }
      trial.hidden = visible_best < kSwallowed || beside_one < kVariant;
      if (trial.hidden) trial.detectable = std::numeric_limits<double>::infinity();
      const bool passing = candidate.event != nullptr && candidate.event->passing();
      if (passing) {  // no other part of the data can foretell it
        trial.gains.resize(ones.size());
        const std::vector<identify::Moments>& sums = trial.settings[trial.best].blocks();
        for (std::size_t b = 0; b < sums.size(); ++b) {
          trial.gains[static_cast<Eigen::Index>(b)] =
              sums[b].yy - sums[b].SquaredError(trial.coefficients);
        }
      } else {
        trial.gains = base_errors - LeftOutErrors(trial.settings, ones, folds);
      }
      CandidateScore& score = trial.score;
      score.name = candidate.name();
      score.psi = candidate.grid[trial.best].psi;
      score.gain = GainOf(trial.gains);
      if (passing) {  // normal noise, as many tries as rows
        score.gain.t = candidate.event->statistic;
        score.gain.p = std::min(1.0, rows * std::erfc(score.gain.t / std::sqrt(2.0)));
      }
      score.gain_share = score.gain.sum / base_sum;
      score.share_error = score.gain.standard_error / base_sum;
      score.explainable_share = score.gain_share * variance / explainable;
      const Eigen::Index own = balance.columns.cols();
      const Eigen::VectorXd extra = trial.coefficients.tail(trial.coefficients.size() - own);
      // One of several may be hardly excited.
      Eigen::VectorXd slack = Eigen::VectorXd::Zero(extra.size());
      if (extra.size() > 1) {
        const Eigen::MatrixXd covariance =
            identify::BlockCovariance(trial.settings[trial.best].blocks(), trial.coefficients);
        slack = 2.0 * covariance.diagonal().tail(extra.size()).cwiseMax(0.0).cwiseSqrt();
      }
      for (Eigen::Index i = 0; i < extra.size(); ++i) {
        const effects::ParameterInfo& info =
            candidate.effect->info().linear[static_cast<std::size_t>(i)];
        score.theta.push_back(scale * extra[i]);
        const double unit = info.relative_to_drive ? scale / drive_share : scale;
        const double off = unit * slack[i];
        if (unit * extra[i] < info.lower - off || unit * extra[i] > info.upper + off) {
          score.physical = false;
        }
      }
      if (ShortestDelay(candidate.effect->info()) > 0.0) {
        score.delay_s = score.theta.front() / drive_share;
      }
      trial.surprise =
          Surprise(balance, fit.coefficients + trial.coefficients.head(balance.columns.cols()));
      const std::vector<identify::Moments> joined =
          Joined(trial.settings[trial.best].blocks(), trial.coefficients, own);
      score.size_in_errors = SizeInErrors(joined);
      score.stable = passing || Stable(joined);
      trials.push_back(std::move(trial));
    }

    report->placebo_99 = BestFalseGain(trials, base, balance, target, folds) / base_sum;

    // A drive that acts late by less than a tenth of a sample is a skew between channels, whatever
    // its name, and teeth that give less than an encoder rounds are rigid: findings, no effects.
    const Trial* delay = nullptr;
    const Trial* rounding = nullptr;
    for (const Trial& trial : trials) {
      const effects::Smallest smallest = trial.candidate->effect->info().smallest;
      const double shortest_s = ShortestDelay(trial.candidate->effect->info());
      if (delay == nullptr && std::abs(trial.score.delay_s) < shortest_s) delay = &trial;
      if (smallest == effects::Smallest::kRounding && BelowRounding(trial)) rounding = &trial;
    }
    const bool skew = delay != nullptr;
    if (rounding != nullptr) rounding_ = rounding->candidate->grid[rounding->best].columns;
    if (skew && delay->candidate->effect->info().smallest == effects::Smallest::kOpening) {
      rounding_ = delay->candidate->grid[delay->best].columns;
    }

    // So is what drifts, whatever happens to drift with it.
    const Eigen::MatrixXd drift = DriftColumns(train_);
    double drift_gain = drift.cols() > 0 ? GainBeside(balance.columns, drift, target).sum : 0.0;
    if (drift_gain < kClearGain * base_sum) drift_gain = 0.0;

    const std::size_t fewest_to_jackknife =
        train_.rows().window.empty() ? kFewestToJackknife : kFewestWindowsToJackknife;
    const double quantile =
        identify::StudentQuantile(0.9772, std::max(1.0, static_cast<double>(blocks.size()) - 1.0)) /
        2.0;  // two standard errors of a normal become this much wider
    for (Trial& trial : trials) {
      CandidateScore& score = trial.score;
      if (trial.hidden) {
        score.refused = "a declared term carries it";
      } else if (!(score.gain.t > options_.fewest_standard_errors * quantile) &&
                 !StandsWithoutTwo(trial, base_sum, report->placebo_99) &&
                 !(blocks.size() >= fewest_to_jackknife && score.size_in_errors > kClearSize)) {
        score.refused = "gain within its error";
      } else if (score.explainable_share < options_.smallest_explainable_share) {
        score.refused = "gain below 5 % of what can be explained";
      } else if (score.gain_share < options_.smallest_residual_share) {
        score.refused = "gain below 5 % of the residual";
      } else if (!IsPassing(trial) && score.gain_share <= report->placebo_99) {
        score.refused = "gain as in recordings without the effect";
      } else if (skew && !IsPassing(trial) &&
                 (trial.candidate == delay->candidate ||
                  GoesWith(trial, -delay->candidate->grid.front().columns, balance, target))) {
        score.refused = declared_.balance == effects::Balance::kGas
                            ? "a delay as short as every valve's opening"
                            : "a skew between channels below a tenth of a sample";
      } else if (WithinCounts(trial, fit.model)) {
        score.refused = "builds up within a few counts of the encoder";
      } else if (rounding != nullptr && NoBetter(trial, *rounding)) {
        score.refused =
            "explains no more than " + rounding->score.name + " below the encoder's rounding";
      } else if (!IsPassing(trial) && score.gain.sum < drift_gain &&
                 (trial.candidate->event != nullptr || GoesWith(trial, drift, balance, target))) {
        score.refused = "a drift explains more";
      } else if (IsPassing(trial) && AsMuch(trials, trial)) {
        score.refused = "what is there all the time explains as much";
      } else if (!score.physical) {
        score.refused = "sign or size is not physical";
      } else if (!score.stable) {
        score.refused = "parts of the data contradict it";
      } else {
        score.accepted = true;
      }
    }
    StepBack(&trials);
    std::stable_sort(trials.begin(), trials.end(), [](const Trial& a, const Trial& b) {
      return a.score.gain.sum > b.score.gain.sum;
    });
    return trials;
  }

  double Surprise(const Balance& balance, const Eigen::VectorXd& coefficients) const {
    const Eigen::VectorXd values = balance.Physical(coefficients);
    double sum = 0.0;
    const auto add = [&](const identify::ParameterRef& ref, double value) {
      if (ref.term >= static_cast<int>(declared_.terms.size())) return;
      const actuator::ParameterValue& nominal = declared_.terms[static_cast<std::size_t>(ref.term)]
                                                    .linear[static_cast<std::size_t>(ref.linear)];
      const double tolerance = actuator::PriorSpread(nominal);
      if (!(tolerance > 0.0)) return;
      sum += (value - nominal.value) * (value - nominal.value) / (tolerance * tolerance);
    };
    const Eigen::Index first = balance.fits_scale ? 1 : 0;
    if (balance.fits_scale) add(balance.drive, values[0]);
    for (std::size_t i = 0; i < balance.parameters.size(); ++i) {
      add(balance.parameters[i], values[first + static_cast<Eigen::Index>(i)]);
    }
    return sum;
  }

  // A declared basic (offset, inertia) that is another candidate under another name steps back.
  static void StepBack(std::vector<Trial>* trials) {
    for (Trial& basic : *trials) {
      if (!basic.candidate->effect->info().basic || !basic.score.accepted) continue;
      for (const Trial& other : *trials) {
        if (other.candidate->effect->info().basic || !other.score.accepted ||
            Correlation(basic.part, other.part) < kTwin) {
          continue;
        }
        basic.score.accepted = false;
        basic.score.refused = "the same as " + other.score.name;
        break;
      }
    }
  }

  // 99th percentile of the best gain of the whole catalogue where there is none: whole blocks of
  // what the best candidate leaves, with random signs, carry the same noise and no effect.
  double BestFalseGain(const std::vector<Trial>& trials, const std::vector<Setting>& base,
                       const Balance& balance, const Eigen::VectorXd& target, int folds) const {
    const std::vector<Block>& blocks = units_.blocks;
    const Trial* best = nullptr;
    for (const Trial& trial : trials) {
      if (trial.hidden || trial.score.gain.sum <= 0.0) continue;
      if (best == nullptr || trial.score.gain.sum > best->score.gain.sum) best = &trial;
    }
    // A small gain of no clear size may be none: taking it out would make the noise too tame.
    if (best != nullptr && best->score.gain_share < kClearGain &&
        best->score.size_in_errors < kSureSize) {
      best = nullptr;
    }
    Eigen::VectorXd noise = target;
    if (best != nullptr) {
      const Eigen::MatrixXd& columns = best->candidate->grid[best->best].columns;
      noise -= balance.columns * best->coefficients.head(balance.columns.cols()) -
               columns * best->coefficients.tail(columns.cols());
    }
    const Eigen::MatrixXd none(target.size(), 0);
    const std::vector<Setting> plain = {
        base.front().Retarget(blocks, balance.columns, none, noise)};
    std::vector<std::vector<Setting>> settings;
    for (const Trial& trial : trials) {
      settings.emplace_back();
      if (trial.hidden || IsPassing(trial)) continue;
      for (std::size_t k = 0; k < trial.settings.size(); ++k) {
        settings.back().push_back(trial.settings[k].Retarget(
            blocks, balance.columns, -trial.candidate->grid[k].columns, noise));
      }
    }
    std::mt19937_64 random(options_.seed);
    std::vector<double> best_false;
    for (int round = 0; round < options_.placebo_rounds; ++round) {
      Eigen::VectorXd signs(static_cast<Eigen::Index>(blocks.size()));
      for (double& sign : signs) sign = (random() & 1) != 0 ? 1.0 : -1.0;
      const double errors = LeftOutErrors(plain, signs, folds).sum();
      double gain = 0.0;
      for (const std::vector<Setting>& trial : settings) {
        if (trial.empty()) continue;
        gain = std::max(gain, errors - LeftOutErrors(trial, signs, folds).sum());
      }
      best_false.push_back(gain);
    }
    return identify::Quantile(best_false, options_.placebo_quantile);
  }

  // Units differ in how much they excite an effect, and that is no doubt about it: a gain that few
  // units give is believed when what all but the best two give is still above the placebo.
  bool StandsWithoutTwo(const Trial& trial, double base_sum, double placebo) const {
    if (trial.gains.size() < 10) return false;
    std::vector<double> gains(trial.gains.data(), trial.gains.data() + trial.gains.size());
    std::partial_sort(gains.begin(), gains.begin() + 2, gains.end(), std::greater<>());
    const double rest = trial.score.gain.sum - gains[0] - gains[1];
    return rest > std::max(placebo, options_.smallest_residual_share) * base_sum;
  }

  static bool IsPassing(const Trial& trial) {
    return trial.candidate->event != nullptr && trial.candidate->event->passing();
  }

  // Does an effect that needs no push from outside gain nearly as much as one?
  static bool AsMuch(const std::vector<Trial>& trials, const Trial& push) {
    return std::any_of(trials.begin(), trials.end(), [&](const Trial& other) {
      return other.candidate->event == nullptr && !other.hidden && other.score.physical &&
             other.score.gain.sum > kSameGain * push.score.gain.sum;
    });
  }

  // Events whose instants stand out join the candidates, and the clocks are set by the one that
  // explains most: there is one clock. A model that holds an event already has it.
  void AddEvents(const FitResult& fit, const actuator::JointModel& model, CandidateSet* set,
                 RoundReport* report) {
    event_.reset();
    for (const actuator::Term& term : model.terms) {
      if (term.effect->info().event) return;
    }
    const Eigen::VectorXd target = fit.balance.target - fit.balance.columns * fit.coefficients;
    Candidate candidate;
    for (Candidate& trial : EventCandidates(model)) {
      // What another effect leaves of its own transients looks like pushes.
      if (trial.effect->info().nonlinear.size() > 1 && !result_.rounds.empty()) continue;
      Event event = FindEvent(train_, trial.effect, units_.blocks, fit.balance.columns, target,
                              options_.placebo_rounds, options_.seed);
      if (!event.significant) {
        CandidateScore score;
        score.name = trial.name();
        score.refused = "no instant stands out";
        report->scores.push_back(std::move(score));
      } else if (!event_ || event.explained > event_->explained) {
        event_ = std::move(event);
        candidate = std::move(trial);
      }
    }
    if (!event_) return;
    SetClocks(event_->start_s, event_->clock_s, &train_);
    candidate.event = &*event_;
    GridPoint point;
    point.psi = {event_->clock_s};
    if (event_->passing()) point.psi.push_back(event_->length_s);
    point.columns = train_.Columns(*event_->effect, point.psi);
    candidate.grid.push_back(std::move(point));
    set->candidates.push_back(std::move(candidate));
  }

  // What extra columns beside a base gain, left out.
  Gain GainBeside(const Eigen::MatrixXd& base, const Eigen::MatrixXd& extra,
                  const Eigen::VectorXd& target) const {
    const std::vector<Block>& blocks = units_.blocks;
    const int folds = Folds(blocks.size());
    const Eigen::VectorXd ones = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(blocks.size()));
    const auto errors = [&](const Eigen::MatrixXd& columns) {
      return LeftOutErrors({Setting(blocks, base, columns, target, folds)}, ones, folds);
    };
    return GainOf(errors(Eigen::MatrixXd(target.size(), 0)) - errors(extra));
  }

  // Where the event happened in the sealed recordings is looked for with the size that the others
  // gave: when it happens is no property of the robot.
  void SetSealedClocks(double theta, const Eigen::VectorXd& residual) {
    const std::vector<double> start_s = LocateEvent(sealed_, *event_, theta, residual);
    SetClocks(start_s, event_->clock_s, &sealed_);
    event_times_.clear();
    const auto note = [&](const Design& design, const std::vector<double>& starts, bool sealed) {
      for (std::size_t run = 0; run < starts.size(); ++run) {
        if (!std::isfinite(starts[run])) continue;
        event_times_.push_back(
            {event_->effect->info().name, design.states().run_names[run], sealed, starts[run]});
      }
    };
    note(train_, event_->start_s, false);
    note(sealed_, start_s, true);
  }

  // No quarter of the blocks asks for the opposite of what all together ask for.
  static bool Stable(const std::vector<identify::Moments>& joined) {
    if (joined.size() < 8) return true;
    const auto power_of = [](const std::vector<identify::Moments>& blocks) {
      double sum = 0.0;
      for (const identify::Moments& block : blocks)
        sum += block.G(block.G.rows() - 1, block.G.rows() - 1);
      return sum;
    };
    const double power = power_of(joined);
    for (std::size_t quarter = 0; quarter < 4; ++quarter) {
      const auto at = [&](std::size_t q) {
        return joined.begin() + static_cast<std::ptrdiff_t>(q * joined.size() / 4);
      };
      const std::vector<identify::Moments> part(at(quarter), at(quarter + 1));
      if (power_of(part) < kSilent * power) continue;
      if (SizeInErrors(part) < -kContradicts) return false;
    }
    return true;
  }

  // rms; 0 where the counts are not known.
  double EncoderRounding_rad() const {
    const double counts = declared_.constants.encoder_counts_per_turn;
    return counts > 0.0 ? kTwoPi / counts / std::sqrt(12.0) : 0.0;
  }

  // Is its rms below that of the encoder's rounding?
  bool BelowRounding(const Trial& trial) const {
    const Eigen::MatrixXd columns = trial.candidate->grid[trial.best].columns(used_, Eigen::all);
    const Eigen::VectorXd theta = Eigen::Map<const Eigen::VectorXd>(
        trial.score.theta.data(), static_cast<Eigen::Index>(trial.score.theta.size()));
    const double rounding = EncoderRounding_rad();
    return (columns * theta).squaredNorm() <
           rounding * rounding * static_cast<double>(used_.size());
  }

  // Does friction build up over a stroke that the encoder hardly resolves? The stroke is that over
  // which all of the model's dry friction would have to build up to leave out the same work.
  bool WithinCounts(const Trial& trial, const actuator::JointModel& model) const {
    const double counts = declared_.constants.encoder_counts_per_turn;
    if (trial.candidate->effect->info().smallest != effects::Smallest::kCounts || counts <= 0.0) {
      return false;
    }
    const std::vector<double> memory(static_cast<std::size_t>(model.memory_size()));
    effects::JointSample forth, back;
    forth.velocity_rad_s = 1e-9;
    back.velocity_rad_s = -1e-9;
    double dry_Nm = 0.0;
    for (std::size_t t = 0; t < model.terms.size(); ++t) {
      if (model.terms[t].effect->memory_size() > 0) continue;  // builds up itself
      const auto term = static_cast<int>(t);
      dry_Nm +=
          (model.TermTorque(term, back, memory) - model.TermTorque(term, forth, memory)) / 2.0;
    }
    const double work_J = trial.score.theta.front() * trial.score.psi.front();
    return work_J < kFewCounts * kTwoPi / counts * dry_Nm;
  }

  static bool NoBetter(const Trial& trial, const Trial& than) {
    if (trial.candidate == than.candidate) return true;
    const Gain ahead = GainOf(trial.gains - than.gains);
    return ahead.sum <= ahead.standard_error;
  }

  // Delays below this are findings, no effects; 0: the effect is no delay.
  double ShortestDelay(const effects::EffectInfo& info) const {
    switch (info.smallest) {
      case effects::Smallest::kTenthOfSample:
        return kShortestDelay / train_.states().rate_Hz;
      case effects::Smallest::kOpening:
        return identify::kOpeningSamples / train_.states().rate_Hz;
      default:
        return 0.0;
    }
  }

  // Does little of a candidate's gain stay when these columns may be fitted as well?
  bool GoesWith(const Trial& trial, const Eigen::MatrixXd& columns, const Balance& balance,
                const Eigen::VectorXd& target) const {
    Eigen::MatrixXd base(balance.columns.rows(), balance.columns.cols() + columns.cols());
    base << balance.columns, columns;
    const Gain kept = GainBeside(base, -trial.candidate->grid[trial.best].columns, target);
    return kept.sum < 0.5 * trial.score.gain.sum;
  }

  static double Correlation(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
    const double power = a.squaredNorm() * b.squaredNorm();
    return power > 0.0 ? std::abs(a.dot(b)) / std::sqrt(power) : 0.0;
  }

  bool Round(actuator::JointModel* model, FitResult* fit) {
    PredictDrive(fit->model);
    CandidateSet set = MakeCandidates(train_, *model);
    if (!options_.only.empty()) {
      std::erase_if(set.candidates, [&](const Candidate& candidate) {
        return std::count(options_.only.begin(), options_.only.end(), candidate.name()) == 0;
      });
      set.missing.clear();
      set.silent.clear();
    }
    RoundReport report;
    report.train_rms = fit->rms;
    report.sealed_rms = identify::ErrorOf(sealed_, fit->model).rms;
    if (options_.only.empty() && declared_.balance == effects::Balance::kMotion) {
      AddEvents(*fit, *model, &set, &report);
    }
    std::vector<Trial> trials = Score(*fit, set, &report);
    result_.rounds.empty() ? NoteWhatIsHidden(set, trials) : NoteWhatShows(trials);

    // Of those that predict the same, within one standard error of the best (Breiman et al. 1984,
    // section 3.4.3), the one that asks least: parameters of its own count as in Akaike's
    // criterion, and so do shifts of the declared parameters, in their tolerances. Of those that
    // ask the same the first of the catalogue.
    const auto asks = [](const Trial& trial) {
      const effects::EffectInfo& info = trial.candidate->effect->info();
      double parameters = static_cast<double>(info.nonlinear.size());
      for (const double theta : trial.score.theta) parameters += theta != 0.0 ? 1.0 : 0.0;
      if (trial.candidate->event != nullptr) {  // an instant of its own in every recording
        parameters += static_cast<double>(trial.candidate->event->start_s.size()) - 1.0;
      }
      return trial.surprise + 2.0 * parameters;
    };
    std::size_t best = 0;
    while (best < trials.size() && !trials[best].score.accepted) ++best;
    std::size_t chosen = best;
    for (std::size_t i = best + 1; i < trials.size(); ++i) {
      if (!trials[i].score.accepted) continue;
      const Gain behind = GainOf(trials[best].gains - trials[i].gains);
      const bool alike = Correlation(trials[best].part, trials[i].part) > kSameClass;
      if (behind.sum > (alike ? trials[best].score.gain.standard_error : behind.standard_error)) {
        continue;
      }
      const double more = asks(trials[i]) - asks(trials[chosen]);
      const bool first =
          trials[i].candidate->catalogue_order < trials[chosen].candidate->catalogue_order;
      // What cannot be told apart at all is told apart by nothing.
      const bool twin = Correlation(trials[chosen].part, trials[i].part) > kTwin;
      if (twin ? first : more < -1.0 || (more < 1.0 && first)) chosen = i;
    }
    for (Trial& trial : trials) {
      trial.score.sealed_rms = SealedWith(*fit, trial);
    }
    std::vector<CandidateScore> scores;
    for (const Trial& trial : trials) scores.push_back(trial.score);
    report.scores.insert(report.scores.begin(), scores.begin(), scores.end());
    if (chosen == trials.size()) {
      result_.rounds.push_back(std::move(report));
      return false;
    }
    const Trial& winner = trials[chosen];
    FoundEffect found;
    found.name = winner.score.name;
    found.balance = winner.candidate->effect->info().balance;
    found.gain_share = winner.score.gain_share;
    found.gain_error = winner.score.share_error;
    found.p = winner.score.gain.p;
    found.weak_evidence = result_.units < kConvincingUnits;
    found.train_before = fit->rms;
    found.sealed_before = report.sealed_rms;
    for (std::size_t i = 0; i < trials.size(); ++i) {
      if (i == chosen || trials[i].hidden || !trials[i].score.physical) continue;
      const Gain behind = GainOf(winner.gains - trials[i].gains);
      const bool close = trials[i].score.accepted && behind.sum <= behind.standard_error;
      const bool same_class = trials[i].score.gain_share > kSameGain * winner.score.gain_share &&
                              Correlation(winner.part, trials[i].part) > kSameClass;
      const bool twin = trials[i].candidate->effect->info().basic &&
                        Correlation(winner.part, trials[i].part) > kTwin;
      if ((close || same_class) && !twin) found.rivals.push_back(trials[i].score.name);
    }
    report.added = found.name;

    actuator::JointModel next = fit->model;
    actuator::Term term;
    term.effect = winner.candidate->effect;
    term.declared = false;
    for (const double theta : winner.score.theta) {
      term.linear.push_back({.value = theta, .half_width_95 = std::nullopt});
    }
    const auto& infos = term.effect->info().nonlinear;
    for (std::size_t i = 0; i < winner.score.psi.size(); ++i) {
      actuator::ParameterValue value{.value = winner.score.psi[i], .half_width_95 = std::nullopt};
      value.fixed = infos[i].dimension == effects::Dimension::kNone     // counts stay whole
                    || (i == 0 && winner.candidate->event != nullptr);  // the clocks are set by it
      term.nonlinear.push_back(value);
    }
    next.terms.push_back(std::move(term));
    found.term = static_cast<int>(next.terms.size()) - 1;
    const FitResult before = *fit;
    *fit = identify::RefineModel(train_, next, units_.blocks);
    PredictDrive(fit->model);
    *fit = identify::RefineModel(train_, fit->model, units_.blocks);
    if (!std::isfinite(fit->rms)) {
      report.added.clear();
      for (CandidateScore& score : report.scores) {
        if (score.name != found.name) continue;
        score.accepted = false;
        score.refused = "no drive gives the torque with it";
      }
      *fit = before;
      PredictDrive(fit->model);
      result_.rounds.push_back(std::move(report));
      return false;
    }
    *model = fit->model;
    found.train_after = fit->rms;
    found.sealed_after = identify::ErrorOf(sealed_, fit->model).rms;
    if (winner.candidate->event != nullptr) {
      actuator::JointModel without = fit->model;
      const double theta = without.terms.back().linear.front().value;
      without.terms.pop_back();
      SetSealedClocks(theta, identify::ResidualTorque(sealed_, without));
      found.sealed_after = identify::ErrorOf(sealed_, fit->model).rms;
      result_.events.insert(result_.events.end(), event_times_.begin(), event_times_.end());
    }
    result_.effects.push_back(std::move(found));
    result_.rounds.push_back(std::move(report));
    return true;
  }

  double SealedWith(const FitResult& fit, const Trial& trial) {
    const Balance balance = identify::MakeBalance(sealed_, fit.model, fit.keep_scale);
    const Eigen::Index p = balance.columns.cols();
    const Eigen::VectorXd b = fit.coefficients + trial.coefficients.head(p);
    const double scale = balance.fits_scale ? 1.0 / b[0] : 1.0;
    const Eigen::VectorXd without = balance.target - balance.columns * b;
    if (trial.candidate->event != nullptr) {
      SetSealedClocks(scale * trial.coefficients[p], scale * without);
    }
    const Eigen::MatrixXd extra = sealed_.Columns(*trial.candidate->effect, trial.score.psi);
    const Eigen::VectorXd error = without + extra * trial.coefficients.tail(extra.cols());
    const std::vector<Eigen::Index> rows = sealed_.rows().UsedRows();
    return std::abs(scale) * std::sqrt(SumSquares(error, rows) /
                                       std::max<double>(1.0, static_cast<double>(rows.size())));
  }

  // The common filter's cut-off, for effects that may swing faster; 0: the effect is none of them.
  double FilteredAbove_Hz(const effects::EffectInfo& info) const {
    const double cutoff_Hz = train_.options().parallel_cutoff_Hz;
    for (const effects::ParameterInfo& parameter : info.nonlinear) {
      if (parameter.dimension != effects::Dimension::kFrequency) continue;
      if (parameter.upper > cutoff_Hz) return cutoff_Hz;
    }
    return 0.0;
  }

  void NoteWhatIsHidden(const CandidateSet& set, const std::vector<Trial>& trials) {
    for (const MissingSignals& missing : set.missing) {
      result_.not_excited.push_back({missing.effect, "not recorded: " + missing.fields});
    }
    for (const MissingSignals& silent : set.silent) {
      result_.not_excited.push_back(
          {silent.effect, silent.fields + " tells nothing but its noise"});
    }
    for (const Trial& trial : trials) {
      if (const double above_Hz = FilteredAbove_Hz(trial.candidate->effect->info());
          above_Hz > 0.0) {
        char text[80];
        std::snprintf(text, sizeof text, "a resonance above %.3g Hz is filtered out", above_Hz);
        result_.not_excited.push_back({trial.score.name, text});
      } else if (std::isinf(trial.detectable)) {
        result_.not_excited.push_back(
            {trial.score.name,
             "the declared terms carry all of it: only a shift of parameters shows"});
      } else if (trial.detectable > kHiddenShare) {
        result_.not_excited.push_back(
            {trial.score.name,
             "up to " + std::to_string(static_cast<int>(100.0 * trial.detectable)) + " % of the " +
                 (declared_.balance == effects::Balance::kMotion ? "drive torque"
                                                                 : "measured side") +
                 " could hide in this motion"});
      } else {
        result_.judged.push_back(trial.score.name);
      }
    }
    std::sort(result_.not_excited.begin(), result_.not_excited.end(),
              [](const NotExcited& a, const NotExcited& b) { return a.effect < b.effect; });
  }

  // What a strong effect hid may show beside it.
  void NoteWhatShows(const std::vector<Trial>& trials) {
    for (const Trial& trial : trials) {
      if (trial.detectable > kHiddenShare) continue;
      if (FilteredAbove_Hz(trial.candidate->effect->info()) > 0.0) continue;
      const auto hidden = std::erase_if(result_.not_excited, [&](const NotExcited& told) {
        return told.effect == trial.score.name;
      });
      if (hidden > 0) result_.judged.push_back(trial.score.name);
    }
  }

  // An effect that the later ones made superfluous goes.
  void TryToRemove(actuator::JointModel* model, FitResult* fit) {
    if (result_.effects.size() < 2) return;
    for (std::size_t e = 0; e + 1 < result_.effects.size();) {
      actuator::JointModel without = fit->model;
      const auto at = static_cast<std::size_t>(result_.effects[e].term);
      const actuator::Term term = without.terms[at];
      without.terms.erase(without.terms.begin() + static_cast<std::ptrdiff_t>(at));
      const FitResult less = identify::FitModel(train_, without, units_.blocks);
      const Gain gain = GainBeside(less.balance.columns,
                                   -train_.Columns(*term.effect, actuator::NonlinearValues(term)),
                                   less.balance.target - less.balance.columns * less.coefficients);
      if (gain.t > options_.fewest_standard_errors) {
        ++e;
        continue;
      }
      for (FoundEffect& other : result_.effects) {
        if (other.term > static_cast<int>(at)) --other.term;
      }
      result_.effects.erase(result_.effects.begin() + static_cast<std::ptrdiff_t>(e));
      *fit = identify::RefineModel(train_, without, units_.blocks);
      *model = fit->model;
    }
  }

  void FindSwallowed(FitResult* fit) {
    PredictDrive(fit->model);
    const CandidateSet set = MakeCandidates(train_, fit->model);
    ShiftReport report = FindShifts(train_, declared_, *fit, set.candidates);
    result_.shifts = std::move(report.shifts);
    if (report.causes.empty()) return;
    const SwallowedCause& best = report.causes.front();
    FoundEffect found;
    found.name = best.candidate.name();
    found.balance = best.candidate.effect->info().balance;
    found.swallowed = true;
    found.weak_evidence = result_.units < kConvincingUnits;
    for (std::size_t i = 1; i < report.causes.size(); ++i) {
      if (report.causes[i].after < best.after + 1.0) {
        found.rivals.push_back(report.causes[i].candidate.name());
      }
    }
    // The plain reading: the declared parameters are off by more than was stated.
    for (const ParameterShift& shift : result_.shifts) {
      const bool shares =
          std::find(shift.causes.begin(), shift.causes.end(), found.name) != shift.causes.end();
      if (shares &&
          std::find(found.rivals.begin(), found.rivals.end(), shift.effect) == found.rivals.end()) {
        found.rivals.push_back(shift.effect);
      }
    }
    found.gain_share = best.before > 0.0 ? 1.0 - best.after / best.before : 0.0;
    found.p = std::exp(-0.5 * std::min(1400.0, best.before - best.after));
    // Before: the best that the model can do inside its stated tolerances.
    const actuator::JointModel held = identify::FitWithinTolerances(train_, declared_);
    found.train_before = identify::ErrorOf(train_, held).rms;
    found.sealed_before = identify::ErrorOf(sealed_, held).rms;
    if (result_.effects.empty()) {
      result_.before_train = identify::ErrorOf(train_, held);
      result_.before_sealed = identify::ErrorOf(sealed_, held);
    }

    // The effect joins the model with the size the shifts ask for; the declared terms are fitted
    // again.
    actuator::JointModel next = fit->model;
    actuator::Term term;
    term.effect = best.candidate.effect;
    term.declared = false;
    actuator::ParameterValue value{.value = best.theta, .half_width_95 = best.half_width_95};
    value.fixed = true;
    term.linear.push_back(value);
    next.terms.push_back(std::move(term));
    found.term = static_cast<int>(next.terms.size()) - 1;
    *fit = identify::FitModel(train_, next, units_.blocks);
    fit->model.terms.back().linear.front().fixed = false;
    result_.corrected = fit->model;
    result_.corrected_fit = *fit;
    found.train_after = fit->rms;
    found.sealed_after = identify::ErrorOf(sealed_, fit->model).rms;
    result_.effects.push_back(std::move(found));
  }

  void FindUnexplained(const FitResult& fit) {
    PredictDrive(fit.model);
    const Balance& balance = fit.balance;
    const double scale = balance.fits_scale ? balance.Scale(fit.coefficients) : 1.0;
    Eigen::MatrixXd base(balance.columns.rows(), balance.columns.cols() + rounding_.cols());
    base << balance.columns, rounding_;
    const Eigen::VectorXd residual = balance.target - balance.columns * fit.coefficients;
    const double variance = fit.rms * fit.rms;
    const double floor = result_.noise_floor_rms * result_.noise_floor_rms;
    const auto name = [&](const std::string& variable, double order, double rms, double share) {
      result_.unexplained = {.balance = declared_.balance,
                             .variable = variable,
                             .order_per_turn = order,
                             .rms = scale * rms,
                             .share = share,
                             .experiment = ""};
    };
    const bool kinematic = declared_.balance == effects::Balance::kKinematic;
    if (kinematic && variance > kFarAbove * floor) {
      // Encoders that come apart wander too slowly for units to foretell each other.
      const double share = LevelShare(train_, residual);
      if (share > kWanders) return name("time_s", 0.0, fit.rms * std::sqrt(share) / scale, share);
    }
    const VariableScan scan =
        ScanVariables(train_, units_.blocks, base, residual, Folds(units_.blocks.size()),
                      options_.placebo_rounds, options_.placebo_quantile, options_.seed);
    if (scan.scores.empty()) return;
    const VariableScore& best = scan.scores.front();
    const double explainable = std::max(variance - floor, 0.02 * variance);
    const bool clear =
        best.gain.t > options_.fewest_standard_errors || best.size_in_errors > kClearCurve;
    const bool loud = clear && best.share > scan.placebo_99 && best.share > kNamedShare &&
                      explainable > kLoudRest * variance &&
                      best.share * variance > 0.2 * explainable &&
                      (!kinematic || scale * best.rms > EncoderRounding_rad());
    if (loud) name(best.variable, best.order_per_turn, best.rms, best.share);
  }

  Design& train_;
  Design& sealed_;
  const actuator::JointModel& declared_;
  const TraceOptions& options_;
  TraceResult result_;
  Units units_;
  Eigen::MatrixXd rounding_;  // columns of what is too small to be an effect; may have none
  std::vector<Eigen::Index> used_;
  std::optional<Event> event_;  // of this round
  std::vector<EventTime> event_times_;
};

}  // namespace

TraceResult Trace(Design& train, Design& sealed, const actuator::JointModel& model,
                  const TraceOptions& options) {
  return Tracer(train, sealed, model, options).Run();
}

}  // namespace sinew::trace

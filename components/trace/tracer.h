// From the residual of a model to the effect it lacks.
//
// The steps are those of docs/closing-the-loop.md: refit of the declared terms, noise floor and
// ceiling, blocked cross-validation of every candidate of the catalogue beside the declared terms,
// acceptance against a placebo, rivals, at most three rounds, a try to remove; then what a refit
// swallowed (parameter_shift), what stays unexplained and what the recording could not show. Pure;
// allocates; reads no clock; the seed decides the placebo.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/design.h"
#include "components/identify/fit.h"
#include "components/trace/confirmation.h"
#include "components/trace/cross_validation.h"

namespace sinew::trace {

// Two engines while one replaces the other: blocked cross-validation behind a common filter, and
// one likelihood at the raw rate.
enum class Engine { kBlocks, kLikelihood };

struct TraceOptions {
  Engine engine = Engine::kBlocks;
  std::uint64_t seed = 1;
  int placebo_rounds = 200;
  // Balances and joints that are searched together: any of them may give a false alarm
  // (Bonferroni).
  int searches = 1;
  double placebo_quantile = 0.99;  // of the best false gain; higher when several traces decide
  int max_rounds = 3;
  double fewest_standard_errors = 2.0;
  double smallest_explainable_share = 0.05;  // gain / explainable variance
  double smallest_residual_share = 0.05;     // gain / residual variance
  // Held-out error of the machine that the joint is part of, with this model of the joint and
  // everything else refitted (an arm's other joints and its bodies); none: the joint is all.
  std::function<double(const actuator::JointModel&)> held_out_error;
  std::vector<std::string> only;  // candidates by name; empty: the whole catalogue
  // Called with a line of progress and the share done, 0 to 1.
  std::function<void(const std::string&, double)> progress;
};

// One candidate of one round.
struct CandidateScore {
  std::string name;
  std::vector<double> psi;         // setting that fits best
  std::vector<double> theta;       // fitted linear parameters
  Gain gain;                       // of left-out squared error
  double size_in_errors = 0.0;     // jackknife over units (cross_validation.h)
  double gain_share = 0.0;         // gain / residual variance of the round
  double share_error = 0.0;        // its standard error
  double explainable_share = 0.0;  // gain / explainable
  double visible_share = 0.0;      // part of its power that the other terms do not carry
  bool physical = true;            // sign and range
  bool stable = true;              // no part of the data contradicts it
  bool accepted = false;
  std::string refused;      // why not
  double sealed_rms = 0.0;  // with it added alone
  double delay_s = 0.0;     // effects that are a skew: what it amounts to
};

struct RoundReport {
  double train_rms = 0.0;  // before the round
  double sealed_rms = 0.0;
  double placebo_99 = 0.0;  // best false gain, share of residual variance
  double explainable_rms = 0.0;
  std::vector<CandidateScore> scores;  // best gain first
  std::string added;                   // empty: nothing
  bool slow_motion = false;            // of the second look (slow_motion.h)
};

struct FoundEffect {
  std::string name;
  effects::Balance balance = effects::Balance::kMotion;
  int term = -1;  // in the corrected model
  std::vector<std::string> rivals;
  double gain_share = 0.0;  // of the residual variance when it was found
  double gain_error = 0.0;
  double p = 1.0;
  bool weak_evidence = false;  // fewer than six units
  bool swallowed = false;      // found as a shift of declared parameters
  bool slow_motion = false;    // found where the recordings creep; its errors are of there
  Confirmation confirmation;   // on the held-out recordings
  // Errors before and after it, rms at the output.
  double train_before = 0.0, train_after = 0.0, sealed_before = 0.0, sealed_after = 0.0;
};

// When an event (a payload put on, a push) began in a recording.
struct EventTime {
  std::string effect;
  std::string recording;
  bool sealed = false;
  double start_s = 0.0;
};

struct ParameterShift {
  std::string effect;
  std::string parameter;
  double nominal = 0.0;
  double refit = 0.0;
  double tolerance = 0.0;  // absolute
  double half_width_95 = 0.0;
  double sigma = 0.0;               // (refit - nominal) / sqrt(tolerance^2 + standard error^2)
  std::vector<std::string> causes;  // effects that point the same way
};

struct Unexplained {
  effects::Balance balance = effects::Balance::kMotion;
  std::string variable;         // JointSample field; empty: nothing found
  double order_per_turn = 0.0;  // 0: not periodic
  double rms = 0.0;
  double share = 0.0;  // of the residual variance that the variable predicts
  std::string experiment;
};

struct NotExcited {
  std::string effect;
  std::string reason;
};

enum class Verdict { kNone, kEffect, kUnexplained };

// How well a balance holds without and with what was found, in its own unit.
struct Judgement {
  Verdict verdict = Verdict::kNone;
  std::string unseen;  // why there was nothing to judge; empty: there was
  // Of the largest statistic of the whole search, all balances together; none: the engine of
  // blocks.
  std::optional<double> p_global;
  identify::ModelError nominal_train, nominal_sealed;
  // Declared model, refitted; within its tolerances when the effects are shifts of its parameters.
  identify::ModelError before_train, before_sealed;
  identify::ModelError after_train, after_sealed;
  double noise_floor_rms = 0.0;
  std::string noise_floor_source;
  double ceiling_rms = 0.0;
  double correlation_time_s = 0.0;
  int units = 0;
  std::string unit_kind;  // run, cycle, block
  double unit_length_s = 0.0;
  std::vector<RoundReport> rounds;
  Unexplained unexplained;
};

// Of a balance beside the motion's.
struct BalanceSummary : Judgement {
  effects::Balance balance = effects::Balance::kKinematic;
  std::string unit;  // of the errors
};

struct TraceResult : Judgement {
  bool slow_motion = false;        // the judgement is of slow motion (slow_motion.h)
  actuator::JointModel nominal;    // as declared
  actuator::JointModel declared;   // refitted, nothing added
  actuator::JointModel corrected;  // with the effects
  std::vector<FoundEffect> effects;
  std::vector<FoundEffect> refuted;  // selected in training, refuted on the held-out recordings
  std::vector<EventTime> events;
  std::vector<NotExcited> not_excited;
  std::vector<std::string> judged;  // candidates whose presence or absence the data shows
  std::vector<ParameterShift> shifts;
  std::vector<BalanceSummary> balances;  // beside the motion's (balances.h)
  identify::FitResult declared_fit;
  identify::FitResult corrected_fit;
};

// train and sealed are changed: their predicted drive follows the model.
TraceResult Trace(identify::Design& train, identify::Design& sealed,
                  const actuator::JointModel& model, const TraceOptions& options);

}  // namespace sinew::trace

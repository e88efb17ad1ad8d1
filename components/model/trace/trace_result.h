// Options and result of the search for the cause of a residual.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/trace/enough_data.h"
#include "components/model/trace/posterior.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

enum class ConfirmationVerdict { kNotConfirmed, kConfirmed, kRefuted };

// "confirmed", "not confirmed", "refuted".
std::string_view ConfirmationWord(ConfirmationVerdict verdict);

// The verdict is that of the score (facts.h).
struct Confirmation {
  ConfirmationVerdict verdict = ConfirmationVerdict::kNotConfirmed;
  double slope = 0.0;
  double lower = 0.0, upper = 0.0;  // 95 %
  int blocks = 0;
};

struct TraceOptions {
  InForce in_force{};
  std::uint64_t seed = 1;
  // Balances and joints that are searched together: any of them may give a false alarm
  // (Bonferroni).
  int searches = 1;
  // Effects that the held-out recordings neither confirm nor refute stay in the corrected model.
  bool keep_unconfirmed = false;
  // These effects and no others are fitted, whatever the rules of the search say (rotation.h).
  std::optional<std::set<std::string>> agreed{};
  // Effects that the held-out recordings refute stay, too: for sets that are given, not found.
  bool keep_refuted = false;
  // Held-out error of the machine that the joint is part of, with this model of the joint and
  // everything else refitted (an arm's other joints and its bodies); none: the joint is all.
  std::function<double(const actuator::JointModel&)> held_out_error{};
  // Filters and guards that are declared; none: the recordings decide.
  std::optional<identify::ProcessingOptions> processing{};
  // Called with a line of progress and the share done, 0 to 1.
  std::function<void(const std::string&, double)> progress{};
};

// One candidate, alone beside the declared terms.
struct CandidateScore {
  std::string name;
  std::vector<double> psi;    // setting that fits best
  std::vector<double> theta;  // fitted linear parameters
  double statistic = 0.0;     // normal quantile of its gain (null_test.h)
  double gain_share = 0.0;    // misfit that it takes away less its charge, share of the whole
  bool accepted = false;
  Refusal refused;
};

struct FoundEffect {
  std::string name;
  effects::Balance balance = effects::Balance::kMotion;
  int term = -1;  // first of its terms in the corrected model; -1: it is no part of that
  // Its terms as fitted in the search, linear parameters in their own units
  // (actuator::PhysicalTerm).
  std::vector<actuator::Term> fitted;
  Posterior posterior;      // of its name and of others in its place
  double gain_share = 0.0;  // of the misfit, beside the others
  double p = 1.0;
  Confirmation confirmation;  // on the held-out recordings
  Refusal refusal;            // what keeps it out of the model
  double curve = 0.0;         // what the best free curve gains beside the set (facts.h)
  double score = 0.0;         // probability of its name by its facts (facts.h)
  // Errors before and after it, rms at the output.
  double train_before = 0.0, train_after = 0.0, held_out_before = 0.0, held_out_after = 0.0;

  bool in_model() const { return term >= 0; }
  std::vector<std::string> rivals() const { return RivalsOf(posterior); }
};

// Beginning of an event (a payload put on, a push) in a recording.
struct EventTime {
  std::string effect;
  std::string recording;
  bool held_out = false;
  double start_s = 0.0;
};

// Held-out recording in which the zero of the motor's angle lies elsewhere than in training.
struct ZeroTurn {
  std::string effect;
  std::string recording;
  double turn_rad = 0.0;  // motor shaft, -pi to pi
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

// The smallest size of an effect that the search would have found: in 80 % of recordings like these
// the effect, alone, reaches p_global and explained_share (rules.h) at its best shape.
struct DetectableSize {
  std::string effect;
  effects::Balance balance = effects::Balance::kMotion;
  std::string parameter;     // linear one, as in model files; the others of the effect are zero
  std::string unit;          // suffix of the parameter's key; empty: a ratio
  double size = 0.0;         // magnitude, in the parameter's own unit
  double share = 0.0;        // rms of its contribution over that of the measured side
  double of_expected = 0.0;  // over the size that a machine may be expected to have (Bank::spread)
  std::vector<std::pair<std::string, double>> shape;  // nonlinear parameters
};

// Training rows that the fit of the motion's balance uses, by speed, and why not the others.
struct RowUsage {
  struct Speed {
    double up_to = 0.0;  // rad/s or m/s; the classes end at 1/30, 1/10, 1/3 and all of the fastest
    Eigen::Index rows = 0, used = 0;
  };
  std::vector<Speed> by_speed;
  // Reason and rows, in the order of RowUse; at last those too few beside one another and those far
  // outside of the noise.
  std::vector<std::pair<std::string, Eigen::Index>> not_used;
};

enum class Verdict { kNone, kEffect, kUnexplained, kTooLittleData };

// Verdict on a balance, and its errors without and with what was found, in its own unit.
struct Assessment {
  Verdict verdict = Verdict::kNone;
  std::string unseen;  // why no row could be used; empty: rows are used
  // The p of the largest statistic of the whole search, all balances and joints together; none:
  // nothing to assess.
  std::optional<double> p_global;
  identify::ModelError nominal_train, nominal_held_out;
  // Declared model, refitted.
  identify::ModelError before_train, before_held_out;
  identify::ModelError after_train, after_held_out;
  double noise_floor_rms = 0.0;  // of the sensors, measured; 0: unknown
  std::string noise_floor_source;
  double ceiling_rms = 0.0;              // what the richest model leaves
  Eigen::Index rows = 0, used_rows = 0;  // of the training recordings, and of these in the fit
  RowUsage row_usage;
  int blocks = 0;  // independent blocks of rows: cross-validation groups, whose signs are flipped
  double block_length_s = 0.0;
  std::vector<CandidateScore> scores;  // of every candidate, best gain first
  Unexplained unexplained;
};

// Is most of the refitted model's held-out error the noise of the sensors? In power: more than
// half. False where the noise is unknown.
bool NearNoise(const Assessment& assessed);

// Those that training misses most come first.
void SortByGain(std::vector<FoundEffect>* effects);

// Summary of a balance beside the motion's.
struct BalanceSummary : Assessment {
  effects::Balance balance = effects::Balance::kKinematic;
  std::string unit;  // of the errors
};

struct TraceResult : Assessment {
  InForce in_force;  // what decided
  // Errors are of the simulated angle, rad or m, in place of torques (components/model/shooting).
  bool by_simulation = false;
  std::optional<TooLittle> too_little;  // why nothing was fitted; empty: it was
  actuator::JointModel nominal;         // as declared
  actuator::JointModel declared;        // refitted, nothing added
  actuator::JointModel corrected;       // with the effects that are in_model()
  // Selected in training, those that it misses most first: confirmed on the held-out recordings and
  // part of the corrected model; neither confirmed nor refuted there; refuted.
  std::vector<FoundEffect> effects, open, refuted;
  std::vector<EventTime> events;
  std::vector<ZeroTurn> zero_turns;
  std::vector<NotExcited> not_excited;
  std::vector<DetectableSize> detectable;
  std::vector<std::string> assessed;  // candidates whose presence or absence the data shows
  std::vector<ParameterShift> shifts;
  std::vector<BalanceSummary> balances;  // beside the motion's (balances.h)
};

}  // namespace sinew::trace

// Every limit that decides a verdict, in the order in which they are
// applied. A refusal in report.json names its rule; docs/closing-the-loop.md has the same table (a
// test). Pure.
#pragma once

#include <functional>
#include <limits>
#include <set>
#include <span>
#include <string>
#include <string_view>

namespace sinew::trace {

struct Rule {
  const char* id;
  const char* statistic;
  double limit;
  double off;          // limit with which it decides nothing
  const char* source;  // derivation, or the command that calibrates it
};

namespace rules {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

inline constexpr Rule kBlocks = {
    "blocks", "independent blocks of the training recordings (enough_data.h)", 8.0, 0.0,
    "2^(blocks - 1) patterns of signs: fewer than 8 cannot reach p_global"};
inline constexpr Rule kRows = {
    "rows", "used rows of the training recordings for each fitted parameter", 10.0, 0.0,
    "fewer overfit (Harrell 2001, Regression Modeling Strategies, 4.4)"};
inline constexpr Rule kHeldOutBlocks = {
    "held_out_blocks", "independent blocks of the held-out recordings", 4.0, 0.0,
    "fewer give no interval of the slope: Student's t with 2 degrees of freedom is 4.3"};
inline constexpr Rule kGlobalP = {
    "p_global",
    "p of the largest statistic of the whole search, and of a free curve "
    "beside the set (null_test.h)",
    0.01, 1.0, "one alarm in a hundred recordings without an effect"};
inline constexpr Rule kExplainedShare = {
    "explained_share", "net gain of a set, share of the refitted model's misfit", 0.015, 0.0,
    "provisional: on rigs 31-90 (rig_bank) 9 effects with 1.5 to 2 % were right, none wrong; "
    "below, task motion of the other rig without effect gets names"};
inline constexpr Rule kVarianceShare = {"variance_share",
                                        "the same in plain variance of the residual, which "
                                        "suffices: coloured noise hides slow effects from "
                                        "the misfit",
                                        0.05, kNever,
                                        "half of a weak effect (bench/rigs); provisional: on rigs "
                                        "31-90 (rig_bank) plain recordings reach "
                                        "0.02, wrong effects 0.08"};
inline constexpr Rule kPriorPenalty = {"prior_penalty",
                                       "on two feet the same in the misfit of declared values "
                                       "against their tolerances, which suffices",
                                       49.0, kNever,
                                       "seven tolerances: effects that a refit absorbs"};
inline constexpr Rule kShapeMisfit = {
    "shape_misfit",
    "net gain of a further effect, share of the set's before it; mean loss of a true name "
    "(posterior.h)",
    0.10, 0.0, "twice the margin of a class (bench/rigs): what an approximate shape leaves"};
inline constexpr Rule kCurveEvidence = {
    "curve_evidence", "marginal likelihood of a free curve beside the set, nats a row", 0.006, 0.0,
    "provisional, rigs 100300-100327 (rig_bank): at most 0.0032 in 56 plain recordings, 0.0095 and "
    "more in 14 of 18 with an effect outside of the catalogue"};
inline constexpr Rule kCurveShare = {
    "curve_share",
    "net gain of an effect from accelerations or rates whose size depends on the low-pass, share "
    "of "
    "the refitted model's misfit",
    0.04, 0.0,
    "provisional, rigs 31-90 (rig_bank): of such effects below it 2 were right, 10 wrong"};
inline constexpr Rule kRange = {
    "range", "size of an effect over the bound of its physical range that it exceeds", 1.0, kNever,
    "the catalogue's range on any machine: friction does not drive, a delay is not negative"};
inline constexpr Rule kDetectable = {
    "not_excited", "size found in 80 % of recordings, rms as share of the measured side", 0.01,
    kNever, "a hundredth of the drive torque is what identification of robots reaches"};
inline constexpr Rule kAbsorbed = {
    "absorbed", "part of a column's power that the declared terms do not carry", 1e-3, 0.0,
    "three per cent of the amplitude, below the accuracy of the columns"};

inline constexpr Rule kBeyondDrive = {
    "beyond_drive", "rows that a model says could not have been driven, share", 0.05, kNever,
    "the cubic of torque_constant_saturation ends where a third of the torque is lost, a real "
    "drive "
    "levels off: 0.2 to 3 % of the rows of true ones were beyond it (rigs 31-90), 18 % where the "
    "name was wrong (XL330)"};
inline constexpr Rule kRotations = {
    "rotations", "rotations that confirm an effect, over all of them but one (two at least)", 1.0,
    0.0, "one recording may be unlike the others"};
inline constexpr Rule kEvidence = {
    "evidence", "twice the logarithm of a set's marginal likelihood over that without the member",
    24.0, 0.0, "12 nats: under it the evidence alone names wrongly more often than rightly"};
inline constexpr Rule kScore = {
    "score", "probability of the name from its facts (facts.h)", 0.6, 0.0,
    "of a prototype's names above it 94 % were right on machines used for no choice"};
inline constexpr Rule kOpen = {"open", "the same, of a name that is reported as open", 0.2, 0.0,
                               "of a prototype's names below it 4 of 76 were right"};
inline constexpr Rule kInterval = {
    "interval", "largest size of an effect over the half width of its 95 % interval", 1.0, 0.0,
    "what may as well be zero is no correction"};
inline constexpr Rule kRaises = {
    "raises", "held-out error with an effect over that without it", 1.01, kNever,
    "what makes a prediction worse by more than a hundredth is no correction"};
inline constexpr Rule kEventPeak = {
    "event_peak", "matched filter for a push, robust standard deviations of its output", 6.0, 0.0,
    "one of a thousand million normal values is further out"};
inline constexpr Rule kEventAlone = {
    "event_alone", "p of the gap between pushes and the next loudest places (push_search.cc)", 0.01,
    kNever, "as p_global, over all numbers of pushes that are searched for"};

}  // namespace rules

// All of them, in order.
std::span<const Rule> AllRules();

// The rule that decided against something, its statistic and its limit.
struct Refusal {
  std::string rule;  // id; empty: nothing was refused
  double value = 0.0;
  double limit = 0.0;
};

// Rules in force in a run: all, and the whole catalogue, but for what is taken out to measure its
// worth (`rig_bank run --without`). A run has one; the code that decides is given it.
struct InForce {
  std::set<std::string, std::less<>> without_rules{};    // ids
  std::set<std::string, std::less<>> without_effects{};  // names that nothing is searched for under

  // The rule's limit, or `off` when it was taken out.
  double Limit(const Rule& rule) const {
    return without_rules.contains(std::string_view(rule.id)) ? rule.off : rule.limit;
  }
  Refusal RefusedBy(const Rule& rule, double value) const { return {rule.id, value, Limit(rule)}; }
  bool Has(std::string_view effect) const { return !without_effects.contains(effect); }
};

// The table in Markdown, as in docs/closing-the-loop.md.
std::string FormatRules();

}  // namespace sinew::trace

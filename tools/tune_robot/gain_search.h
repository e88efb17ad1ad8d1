// The search of PID gains for a whole robot (Algorithm 2 of the source; the draws are
// tools/tune_pid/search.h's): all trials of a stage are independent, so they run side by side, and
// their outcomes are kept in a table that a search that was stopped goes on from.
//
//     stage 0   named gains to compare with, such as published ones; never the best
//     stage 1   draws from the whole ranges
//     stage 2   draws around the best of stage 1; none when all of stage 1 fell
//
// A trial's cost is its mean squared error; a fall or a fault makes it infinite (lines 6 to 8). The
// trial and the time of its fall stay in the table. The result depends on the seed and the outcomes
// alone, not on the number of threads or on how often the search was stopped. Units: search.h.
#pragma once

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "tools/tune_pid/search.h"

namespace sinew::tune {

// Significant digits of drawn gains: what a configuration is written with.
inline constexpr int kGainDigits = 4;

struct NamedGains {
  std::string name;
  double proportional_Nm_rad = 0.0, integral_Nm_rad_s = 0.0, derivative_Nm_s_rad = 0.0;
};

struct GainTrial {
  int stage = 0, number = 0;
  std::string name;  // of stage 0
  control::PidConfig pid;
  std::optional<ClosedLoopScore> score;  // nothing: not run yet

  double cost() const noexcept { return score ? TrackingCost(*score) : kDiscarded; }
};

struct GainSearchConfig {
  SearchConfig search;
  std::vector<NamedGains> compared;  // stage 0
  control::PidConfig rest;           // filter and limits of every trial
  int threads = 1;
};

struct GainSearchResult {
  std::vector<GainTrial> trials;  // by stage and number
  std::optional<GainTrial> best;  // of stages 1 and 2; nothing: all were discarded
};

// The stages that can be planned with these trials done: 0 and 1, and 2 when all of 0 and 1 are in
// `done` (any order). Trials in `done` take their outcome along. Throws std::invalid_argument
// naming a trial in `done` that this search does not have, or has with other gains.
std::vector<GainTrial> PlanTrials(const GainSearchConfig& config,
                                  const std::vector<GainTrial>& done);

// Least cost, the first of equal ones; of the stages from `first_stage` on.
const GainTrial* BestTrial(const std::vector<GainTrial>& trials, int first_stage = 1) noexcept;

// Runs what is not in `done`.
// run: the score of gains; called by `threads` threads at the same time.
// keep: sees a trial as soon as it is run, one call at a time, in any thread and order.
// progress: in the calling thread, trials done and all of both stages; may be empty.
// What run or keep throws ends the search and is thrown here. Throws std::invalid_argument as
// PlanTrials.
GainSearchResult RunGainSearch(
    const GainSearchConfig& config, const std::vector<GainTrial>& done,
    const std::function<ClosedLoopScore(const control::PidConfig&)>& run,
    const std::function<void(const GainTrial&)>& keep,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace sinew::tune

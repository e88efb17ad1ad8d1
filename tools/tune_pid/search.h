// Two-stage random search of PID gains (Algorithm 2 of the source): stage 1 draws from the whole
// ranges, stage 2 around the best of stage 1; all draws even in the logarithm.
//
// A trial's cost is a function of the gains; kDiscarded, as for gains with which the robot fell
// (lines 5 to 8 of Algorithm 2: the base below its least height ends the trial and the gains do not
// count), is never the best. One thread. Costs are asked for in the order of the draws, which
// depend on the seed alone and not on the costs of their own stage.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <vector>

#include "components/robot/control/pid.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::tune {

inline constexpr double kDiscarded = HUGE_VAL;

struct GainRange {
  double lower = 0.0, upper = 0.0;  // 0 < lower <= upper
};

// Gain that is sought, and its key in files.
struct Gain {
  const char* key;
  double control::PidConfig::*of;
};
inline constexpr Gain kGains[] = {
    {"proportional_Nm_rad", &control::PidConfig::proportional_Nm_rad},
    {"integral_Nm_rad_s", &control::PidConfig::integral_Nm_rad_s},
    {"derivative_Nm_s_rad", &control::PidConfig::derivative_Nm_s_rad},
};
inline bool SameGains(const control::PidConfig& a, const control::PidConfig& b) {
  return std::all_of(std::begin(kGains), std::end(kGains),
                     [&](const Gain& gain) { return a.*gain.of == b.*gain.of; });
}

struct SearchConfig {
  int trials = 80;  // in each stage
  std::uint64_t seed = 1;
  // Nm/rad, Nm/(rad s), Nm s/rad at the output.
  GainRange proportional{1.0, 100.0}, integral{0.1, 100.0}, derivative{0.05, 5.0};
  GainRange around_best{0.7, 1.4};  // factors of stage 2
};

struct Draw {
  int stage = 0, number = 0;
  control::PidConfig pid;
  double cost = kDiscarded;
};

// All draws of a stage, in their order: 1 from the whole ranges, 2 around `center`, the best of
// stage 1. Filter and limits are the center's. They depend on seed, stage and center alone, so that
// trials may run in any order. Throws std::invalid_argument: no trials, another stage, or a range
// that is none.
std::vector<control::PidConfig> DrawStage(const SearchConfig& config, int stage,
                                          const control::PidConfig& center);

// `best`: the least cost so far; a trial whose cost cannot come below it may return kDiscarded.
using TrialCost = std::function<double(const control::PidConfig& pid, double best)>;

// The draw of least cost; nothing when all were discarded. The filter and limits of `rest` stay.
// better: sees every draw that is better than all before; may be empty. Throws
// std::invalid_argument: no trials, or a range that is none.
std::optional<Draw> SearchGains(const SearchConfig& config, const control::PidConfig& rest,
                                const TrialCost& cost,
                                const std::function<void(const Draw&)>& better = {});

// Mean squared error of a trial in the closed loop, rad^2; kDiscarded when the robot fell or a
// fault stopped it.
double TrackingCost(const ClosedLoopScore& score) noexcept;

}  // namespace sinew::tune

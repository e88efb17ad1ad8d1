// Runs an experiment of components/model/experiment on the surrogate, in this process.
//
// Each trial starts in the state that the protocol asks for (angle, pressure, time at rest); a
// robot has to be brought there. The truth comes from the surrogate's parameters, or, where a
// quantity is a load of the run (breakaway, the gas during a stroke), from its noise-free state;
// identification never sees it.
//
// Pure but for the time it takes. One thread per call; calls share nothing.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"
#include "sim/surrogate/parameters.h"

namespace sinew::laboratory {

// How much of an experiment: full as published, coverage for one of many seeds, quick for a look.
enum class Size { kFull, kCoverage, kQuick };

struct Plan {
  Size size = Size::kFull;
  int trials = 0;  // 0: by size. backlash: periods; breakaway: at each angle; pea-data: cycles
  experiment::RigConstants constants{};
  std::uint64_t seed = 1;
};

// The same rig with everything that the experiments look for off by at most `spread`: the
// surrogate's own specimen, and the play.
surrogate::RigParameters MakeSpecimen(const surrogate::RigParameters& rig, double spread,
                                      std::uint64_t seed);

struct Outcome {
  experiment::Result result;
  // What was recorded; one for each trial of `breakaway`, else one.
  std::vector<experiment::Recording> recordings;
  double simulated_s = 0.0;
};

// name: of experiment::ExperimentNames(). Throws std::invalid_argument: no such experiment, or a
// recording that is too short. `progress` is called with the share of the work done, 0 to 1.
Outcome RunOnSurrogate(std::string_view name, const surrogate::RigParameters& specimen,
                       const Plan& plan, const std::function<void(double)>& progress = {});

// Writes the true values into a result made from a recording of this rig, however it was recorded.
void FillTruth(const surrogate::RigParameters& specimen, experiment::Result* result);

}  // namespace sinew::laboratory

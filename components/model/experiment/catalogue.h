// The experiments by name: protocol of one repetition, and the parameters from its recording.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "components/model/experiment/protocol.h"
#include "components/model/experiment/result.h"

namespace sinew::experiment {

// "backlash", "breakaway", "moving-friction", "stiffness", "motor", "sea-data", "pea-data".
const std::vector<std::string>& ExperimentNames();

struct Repetition {
  int trials = 0;  // backlash: periods; pea-data: cycles; 0: as published, or fewer when quick
  bool quick = false;
  double rest_s = 40.0;  // breakaway, at each angle
  double play_rad = 0.0464258;
  double gear_ratio = 100.0;
  std::uint64_t seed = 1;
};

// Throws std::invalid_argument: no such experiment (the message lists them), or bad numbers.
std::unique_ptr<Protocol> MakeProtocol(std::string_view name, const Repetition& repetition);

// Throws std::invalid_argument: the recording has too little data.
Result Identify(std::string_view name, const Recording& rows, const RigConstants& rig);

}  // namespace sinew::experiment

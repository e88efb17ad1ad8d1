// What dropping a part of a joint's model costs: the model with and without it, simulated beside
// held-out recordings by sim/world (tools/verify), positions compared.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/processing.h"
#include "components/types/run.h"
#include "tools/export_model/described_robot.h"

namespace sinew::export_model {

struct Cost {
  std::string effect;  // of Dropped; "all": everything that is dropped at once
  // Simulated less measured position, rms, rad or m, over the samples that both models reached.
  // Nothing: see why_not.
  std::optional<double> without, with;
  std::string why_not;
};

// One entry for each of `dropped`, in its order, and "all" when there are several. robot: of one
// joint; processing: resolved. The terms with their last fitted values: nothing is fitted again.
// Throws std::invalid_argument: more joints than one, recordings that cannot be used.
std::vector<Cost> CostsOf(const std::vector<Dropped>& dropped, const actuator::RobotModel& robot,
                          const std::vector<types::Run>& runs,
                          const identify::ProcessingOptions& processing, double horizon_s);

}  // namespace sinew::export_model

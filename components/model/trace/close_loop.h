// The whole path of `sinew close-loop` between reading and writing: recordings in, what was found
// out, balance by balance. Pure; allocates; reads no clock. Recordings that are too short or too
// still end as kTooLittleData. Throws std::invalid_argument for those that cannot be used: signals
// that the model needs.
#pragma once

#include <optional>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

struct LoopResult {
  identify::ProcessingOptions processing;
  TraceResult trace;
  // Empty when nothing was fitted.
  std::optional<identify::Design> train;  // with the processing of `trace`
  std::optional<identify::Design> held_out;
};

// longest_gap_s: longer gaps cut a recording into pieces. The held-out recordings give figures and
// confirm, and are in no fit.
LoopResult CloseLoop(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out,
                     const actuator::JointModel& joint, double longest_gap_s,
                     const TraceOptions& options);

// Throws std::invalid_argument naming both when a held-out recording holds the same samples as one
// that is trained on.
void RequireHeldOut(const std::vector<types::Run>& train, const std::vector<types::Run>& held_out);

}  // namespace sinew::trace

// The whole path of `sinew close-loop` between reading and writing: recordings in, what was found
// out. The data gate, the states, the trace and the second look where the recordings creep. Pure;
// allocates; reads no clock. Recordings that are too short or too still end as kTooLittleData.
// Throws std::invalid_argument for those that cannot be used: signals that the model needs.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/data_gate.h"
#include "components/identify/design.h"
#include "components/identify/processing.h"
#include "components/identify/run.h"
#include "components/trace/tracer.h"

namespace sinew::trace {

struct LoopResult {
  identify::ProcessingOptions processing;   // resolved; of slow motion when only that look found
  std::vector<identify::Finding> findings;  // of the training recordings
  TraceResult trace;
  // Empty when nothing was judged.
  std::optional<identify::Design> train;  // with the processing that `trace` was judged by
  std::optional<identify::Design> sealed;
};

// wished: what the model file says of the processing, zeros are filled in from the training
// recordings. The sealed recordings give figures only, never a choice.
LoopResult CloseLoop(const std::vector<identify::Run>& train,
                     const std::vector<identify::Run>& sealed, const actuator::JointModel& joint,
                     const identify::ProcessingOptions& wished, const TraceOptions& options);

// Throws std::invalid_argument naming both when a sealed recording holds the same samples as one
// that is trained on.
void RequireSealed(const std::vector<identify::Run>& train,
                   const std::vector<identify::Run>& sealed);

}  // namespace sinew::trace

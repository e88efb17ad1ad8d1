// Several recordings and none held out: each is held out once, and what the rotations agree on is
// fitted to all of them. Pure; allocates.
//
// An effect is agreed on when it, or an effect that names it as its rival, is confirmed in all
// rotations but one, in two at least, and refuted in none. The errors on held-out recordings are
// those of the rotations, each of a model that was not fitted to the recording.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "components/trace/close_loop.h"

namespace sinew::trace {

struct Rotation {
  std::string held_out;  // name of the recording
  identify::ProcessingOptions processing;
  TraceResult trace;
};

struct RotatedLoop {
  // Fitted to all recordings with the effects that were agreed on. Its held-out errors, and those
  // of its effects, are the rotations', squares weighted by the recordings' rows; confirmations are
  // the weakest that count.
  LoopResult all;
  std::vector<Rotation> rotations;
};

std::set<std::string> AgreedEffects(const std::vector<Rotation>& rotations);

// runs: two at least, with different samples; of rows that follow each other. Throws
// std::invalid_argument.
RotatedLoop RotateLoop(const std::vector<identify::Run>& runs, const actuator::JointModel& joint,
                       double longest_gap_s, const TraceOptions& options);

}  // namespace sinew::trace

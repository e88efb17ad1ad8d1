// Several recordings and none held out: each is held out once, and what the rotations agree on is
// fitted to all of them. Pure; allocates.
//
// An effect is agreed on when it, or an effect that names it as its rival, is confirmed in all
// rotations but one, in two at least, and refuted in none. The errors on held-out recordings are
// those of the rotations, each of a model that was not fitted to the recording.
#pragma once

#include <functional>
#include <set>
#include <string>
#include <vector>

#include "components/model/trace/close_loop.h"

namespace sinew::trace {

struct Rotation {
  std::string held_out;  // name of the recording
  identify::ProcessingOptions processing;
  TraceResult trace;
};

// Task of a rotation.
struct Fold {
  std::vector<types::Run> train;
  types::Run held_out;
  actuator::JointModel joint;
  // As TraceOptions::held_out_error, of these recordings.
  std::function<double(const actuator::JointModel&)> held_out_error;
};

// Each recording held out once. Throws std::invalid_argument unless there are two at least, with
// different samples, and either all or none of them rows of positions that were held.
std::vector<Fold> LeaveOneOut(const std::vector<types::Run>& runs,
                              const actuator::JointModel& joint);

struct RotatedLoop {
  // Fitted to all recordings with the effects that were agreed on. Its held-out errors, and those
  // of its effects, are the rotations', squares weighted by the recordings' rows; confirmations are
  // the weakest that count.
  LoopResult all;
  std::vector<Rotation> rotations;
};

std::set<std::string> AgreedEffects(const std::vector<Rotation>& rotations);

// folds: of these runs. joint and options are those of the last fit, to all runs; what a fold says
// itself counts there.
RotatedLoop RotateLoop(const std::vector<Fold>& folds, const std::vector<types::Run>& runs,
                       const actuator::JointModel& joint, double longest_gap_s,
                       const TraceOptions& options);

}  // namespace sinew::trace

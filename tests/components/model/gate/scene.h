// Recordings of the lab's rig as the surrogate plays it, with or without undeclared
// effects, and what a laboratory would declare of it. In process, no files, everything from the
// seed.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing.h"
#include "sim/surrogate/excitation.h"
#include "sim/surrogate/undeclared.h"

namespace sinew::scene {

struct Scene {
  surrogate::ExcitationKind excitation = surrogate::ExcitationKind::kDesigned;
  std::uint64_t seed = 1;  // of specimen, motion, noise and what the laboratory declares
  int trains = 3;
  double seconds = 60.0;          // of each recording
  double coloured_noise_A = 0.0;  // on the current, standard deviation; 0.1 s of memory
  double cycle_Hz = 240.0;        // of the controller
  int log_every = 3;              // cycles per row
  bool silent = false;            // sensors neither round nor scatter, no jitter, no lost rows
  bool held_out = true;           // false: training recordings only
  std::vector<surrogate::EffectSpec> effects;
};

struct Recorded {
  std::vector<types::Run> train, held_out;
  actuator::JointModel declared;  // nominal values 5 to 15 % off, tolerances of 15 %
  actuator::JointModel specimen;  // the same terms at their true values
  identify::ProcessingOptions processing;
};

// Training runs carry 0 and 0.5 kg by turns and start at different temperatures when the motion is
// designed. An effect that comes during a run (payload_step, external_bump) comes at a time of the
// run's own.
Recorded Record(const Scene& scene);

}  // namespace sinew::scene

// The part of a residual that is noise of the sensors. Pure; allocates.
#pragma once

#include <string>

#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"

namespace sinew::trace {

struct NoiseFloor {
  double rms = 0.0;    // torque at the output, after the parallel filter; 0: unknown
  std::string source;  // "standstill", "sample-to-sample scatter", ""
};

// From spells at rest (drive and known torques, straight line removed from each), and from the
// scatter of the drive from sample to sample, taken as white: the lower one.
NoiseFloor EstimateNoiseFloor(const identify::Design& design, const identify::Balance& balance,
                              double drive_factor);

}  // namespace sinew::trace

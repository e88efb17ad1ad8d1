// Reads `schema: sinew-body-disturbance/1`.
//
//   schema: sinew-body-disturbance/1
//   disturbances:
//     - at_s: 18.5                 # since the robot was armed first
//       for_s: 10                  # left out: to the end of the session
//       payload: {link: torso, mass_kg: 4, place_m: [0.1, 0, 0.1]}           # in the link's frame
//     - at_s: 5
//       for_s: 0.1
//       push: {link: torso, force_N: [60, 0, 0], place_m: [0, 0, 0.15]}      # force: world axes
//
// An entry has a payload, a push or both. Links are named as in the URDF. Throws UsageError (one
// line: file, line, key, expected).
#pragma once

#include <filesystem>

#include "components/base/config/config.h"
#include "sim/body_disturbance/schedule.h"

namespace sinew::body_disturbance {

Schedule LoadSchedule(const std::filesystem::path& path);
// The same of a file that is open.
Schedule ReadSchedule(const config::Section& root);

}  // namespace sinew::body_disturbance

// Reads `schema: sinew-body-disturbance/1`.
//
// Links are named as in the URDF. Throws UsageError (one
// line: file, line, key, expected).
#pragma once

#include <filesystem>

#include "components/base/config/fields.h"
#include "sim/body_disturbance/schedule.h"

namespace sinew::body_disturbance {

inline constexpr char kSchema[] = "sinew-body-disturbance/1";

struct ScheduleParts {
  std::vector<Payload> payloads;
  std::vector<Push> pushes;
  std::vector<LostDrive> lost_drives;
  std::vector<LostFriction> lost_frictions;
};

void Describe(config::Fields& fields, ScheduleParts& parts);
Schedule LoadSchedule(const std::filesystem::path& path);
// The same of a file that is open.
Schedule ReadSchedule(const config::Section& root);

}  // namespace sinew::body_disturbance

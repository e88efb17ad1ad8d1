// Reads `schema: sinew-recorded-reference/1` (docs/participants/recorded_reference.md) and the
// recording that it names.
#pragma once

#include <filesystem>

#include "components/base/config/fields.h"
#include "components/robot/reference/robot_reference.h"

namespace sinew::stand_ins {

inline constexpr char kSchema[] = "sinew-recorded-reference/1";

struct RecordedReferenceFile {
  std::filesystem::path recording;
  double soft_start_s = 1.0;
  double start_delay_s = 0.0;
  reference::StartRule start = reference::StartRule::kArmed;
};

void Describe(config::Fields& f, RecordedReferenceFile& c);

// The first session of the recording whose reference asked for something, from there on, with the
// period of its joint_state. Throws UsageError naming file and key, or what the recording lacks.
reference::RobotReferenceConfig LoadRecordedReference(const std::filesystem::path& path);

}  // namespace sinew::stand_ins

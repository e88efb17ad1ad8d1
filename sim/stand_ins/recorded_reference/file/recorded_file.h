// Reads `schema: sinew-recorded-reference/1` (docs/participants/recorded_reference.md) and the
// recording that it names.
#pragma once

#include <filesystem>

#include "components/robot/reference/robot_reference.h"

namespace sinew::stand_ins {

// The first session of the recording whose reference asked for something, from there on, with the
// period of its joint_state. Throws UsageError naming file and key, or what the recording lacks.
reference::RobotReferenceConfig LoadRecordedReference(const std::filesystem::path& path);

}  // namespace sinew::stand_ins

// Runs of measured signals from a file: CSV or a bag of ROS 2 with a mapping, or an MCAP recording.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/types/run.h"
#include "components/record/recording/body_builder.h"

namespace sinew::recording {

// CSV (any name that does not end in .mcap): one run; `map` must name a mapping file.
// A bag of ROS 2 (ros_bag.h): one run; without `map` that of MapOfRosBag.
// MCAP: one run per session (a start of the state provider, or an imported file), in file order;
// `map` is not read and may be empty. A run's rows are the ticks that have a joint_state with a
// valid joint and, where the recording has one, a valid actuator_state; signals are those that
// measured_flags names and, when recorded throughout, the reference position. A recording that was
// cut off is read as far as it goes.
//
// FILE@START:END reads the rows of that time alone (recording_path.h); of several sessions those
// that have any.
//
// joint: index of the joint in a recording, or of those that the mapping describes.
// Throws UsageError naming the file and line, key or byte.
std::vector<types::Run> ReadRuns(const std::filesystem::path& path,
                                 const std::filesystem::path& map = {}, int joint = 0);

// Forces of the feet and IMU of an MCAP recording (body_builder.h), its whole time: of
// FILE@START:END the range is not applied, since rows are matched with those of ReadRuns by their
// time. Throws UsageError naming the file and the topic.
BodyRun ReadBody(const std::filesystem::path& path);

}  // namespace sinew::recording

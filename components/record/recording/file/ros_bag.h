// Bags of ROS 2 (rosbag2): a folder with metadata.yaml, or one file of it, in MCAP or sqlite3.
#pragma once

#include <filesystem>

#include "components/record/recording/csv_map.h"
#include "components/record/recording/ros_table.h"

namespace sinew::recording {

// A folder, a .db3 file, or an MCAP file of the profile "ros2".
bool IsRosBag(const std::filesystem::path& path);

// Files in the order of metadata.yaml. `notes` receives what is left out or is not whole, if given.
// Throws UsageError naming file and topic: no bag, a compressed one, a message that is none of its
// type.
RosTable ReadRosBag(const std::filesystem::path& path, std::vector<std::string>* notes = nullptr);

// The mapping of a bag without one: all joints of its only JointState topic as rotary joints,
// effort as torque. Throws UsageError or std::invalid_argument when there is no or more than one
// such topic.
CsvMap MapOfRosBag(const RosTable& table, const std::filesystem::path& path);

}  // namespace sinew::recording

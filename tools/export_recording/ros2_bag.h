// A recording as a bag of ROS 2: a folder with metadata.yaml (rosbag2, version 5 of its layout) and
// one MCAP file of the profile "ros2".
//
// | topic of the recording | topic of the bag | type |
// | joint_state | /joint_states | sensor_msgs/msg/JointState: position, velocity, effort =
// torque_Nm | | imu | /imu/data | sensor_msgs/msg/Imu, covariances 0 (unknown) | | foot_force |
// /foot_force/right_0 .. left_3 | geometry_msgs/msg/WrenchStamped: force.z |
//
// header.stamp is the message's own stamp_ns, log_time that of RecordedTime: the bag plays as fast
// as the robot moved, in lockstep as well, and where the clock was set back. What a robot did not
// measure is not repeated: lost joints are NaN, a lost IMU or foot sensor has no message.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "components/record/recording/file/recording_path.h"
#include "tools/export_recording/tables.h"

namespace sinew::export_recording {

// Names that messages of ROS 2 carry and recordings do not.
struct RosNames {
  std::vector<std::string> joints;          // empty: joint_0, joint_1, ...
  std::array<std::string, 8> force_frames;  // in the order of foot_force; empty: foot_force_0, ...
  std::string imu_frame = "imu";
};

struct RosBag {
  std::vector<Written> topics;        // of the bag; fields 0
  std::vector<std::string> left_out;  // topics of the recording that have no message there
  std::string cut_off;                // why the recording's end is missing; empty: it is whole
};

// Into the folder, which must be there and empty. Throws UsageError naming the recording: one that
// cannot be read, without any of these topics, with other fields, or with more joints than names;
// std::runtime_error when a file cannot be written.
RosBag WriteRosBag(const recording::RecordingPath& path, const RosNames& names,
                   const std::filesystem::path& folder);

}  // namespace sinew::export_recording

// The messages of ROS 2 that a bag is written with, as published in ros2/common_interfaces and
// ros2/rcl_interfaces: their definitions in the "ros2msg" encoding of the MCAP registry, and their
// CDR. Pure; allocates.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "components/record/recording/bytes.h"

namespace sinew::export_recording {

inline constexpr const char* kRosJointState = "sensor_msgs/msg/JointState";
inline constexpr const char* kRosImu = "sensor_msgs/msg/Imu";
inline constexpr const char* kRosWrenchStamped = "geometry_msgs/msg/WrenchStamped";

// The definition of one of these with all that it refers to. Throws std::invalid_argument for
// another name.
std::string RosDefinition(const std::string& type);

struct RosHeader {
  std::int64_t stamp_ns = 0;
  std::string frame_id;
};

struct RosJointState {
  RosHeader header;
  std::vector<std::string> names;
  std::vector<double> positions, velocities, efforts;  // rad, rad/s, Nm, or m, m/s, N
};

struct RosImu {
  RosHeader header;
  std::array<double, 4> orientation_xyzw{};
  std::array<double, 3> angular_velocity_rad_s{}, acceleration_m_s2{};
};

struct RosWrench {
  RosHeader header;
  std::array<double, 3> force_N{}, torque_Nm{};
};

// Little-endian, with the 4-byte encapsulation header. Covariances are 0: unknown (Imu.msg).
recording::Bytes EncodeRos(const RosJointState& message);
recording::Bytes EncodeRos(const RosImu& message);
recording::Bytes EncodeRos(const RosWrench& message);

}  // namespace sinew::export_recording

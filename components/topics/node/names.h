// The names of topics, types and joints on the wire: our own, or with SINEW_ROS2_NAMES
// (cmake/SinewOptions) those that ROS 2 gives its messages.
//
// | | topic | type |
// | as built by default | joint_state | sinew::msg::JointState_1a2b3c4d, with the hash of its IDL |
// | SINEW_ROS2_NAMES | rt/joint_state | sinew::msg::dds_::JointState_ |
//
// Source: ROS 2 design, "Topic and Service name mapping to DDS"; rosidl_typesupport names
// PACKAGE::msg::dds_::TYPE_. Pure; any thread.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sinew::node::internal {

std::string RegisteredTopicName(const std::string& name);

// type_name: "sinew::msg::JointState".
std::string RegisteredTypeName(const std::string& type_name, const std::string& idl_hash);

// The USER_DATA (OMG DDS 1.4, 2.2.3.1) of a participant that commands joints: "sinew-joints/1" and
// the names, each ended by a zero byte. Of anything else: no names.
std::vector<std::uint8_t> JointNamesOnWire(const std::vector<std::string>& names);
std::vector<std::string> JointNamesFromWire(const std::vector<std::uint8_t>& user_data);

}  // namespace sinew::node::internal

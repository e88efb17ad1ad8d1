#include "tools/export_recording/ros2_messages.h"

#include <map>
#include <stdexcept>

namespace sinew::export_recording {
namespace {

using recording::Bytes;

struct Definition {
  std::string fields;
  std::vector<std::string> used;  // types that it refers to, directly or not
};

// Fields of the published .msg files, without their comments.
const std::map<std::string, Definition>& Definitions() {
  static const std::map<std::string, Definition> kDefinitions = {
      {"builtin_interfaces/Time", {"int32 sec\nuint32 nanosec\n", {}}},
      {"std_msgs/Header", {"builtin_interfaces/Time stamp\nstring frame_id\n", {}}},
      {"geometry_msgs/Vector3", {"float64 x\nfloat64 y\nfloat64 z\n", {}}},
      {"geometry_msgs/Quaternion", {"float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1\n", {}}},
      {"geometry_msgs/Wrench", {"Vector3 force\nVector3 torque\n", {}}},
      {"sensor_msgs/JointState",
       {"std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
        "float64[] effort\n",
        {"std_msgs/Header", "builtin_interfaces/Time"}}},
      {"sensor_msgs/Imu",
       {"std_msgs/Header header\ngeometry_msgs/Quaternion orientation\n"
        "float64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
        "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\n"
        "float64[9] linear_acceleration_covariance\n",
        {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Quaternion",
         "geometry_msgs/Vector3"}}},
      {"geometry_msgs/WrenchStamped",
       {"std_msgs/Header header\nWrench wrench\n",
        {"std_msgs/Header", "builtin_interfaces/Time", "geometry_msgs/Wrench",
         "geometry_msgs/Vector3"}}},
  };
  return kDefinitions;
}

class RosEncoder {
 public:
  template <class Number>
  void Put(Number value) {
    const std::size_t size = sizeof(value);
    bytes_.resize(kHeader + (bytes_.size() - kHeader + size - 1) / size * size);
    const auto* first = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), first, first + size);
  }
  void Text(const std::string& text) {
    Put(static_cast<std::uint32_t>(text.size() + 1));
    recording::PutRaw(&bytes_, text);
    bytes_.push_back(std::byte{0});
  }
  void Fixed(std::span<const double> values) {
    for (const double value : values) Put(value);
  }
  void Sequence(std::span<const double> values) {
    Put(static_cast<std::uint32_t>(values.size()));
    Fixed(values);
  }
  void Header(const RosHeader& header) {
    // Seconds below the stamp: nanosec is never negative.
    constexpr std::int64_t kSecond = 1'000'000'000;
    const std::int64_t rest = (header.stamp_ns % kSecond + kSecond) % kSecond;
    Put(static_cast<std::int32_t>((header.stamp_ns - rest) / kSecond));
    Put(static_cast<std::uint32_t>(rest));
    Text(header.frame_id);
  }
  Bytes Take() { return std::move(bytes_); }

 private:
  static constexpr std::size_t kHeader = 4;
  Bytes bytes_ = {std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
};

constexpr std::array<double, 9> kUnknownCovariance{};

}  // namespace

std::string RosDefinition(const std::string& type) {
  const std::size_t cut = type.find("/msg/");
  const std::string name =
      cut == std::string::npos ? type : type.substr(0, cut) + type.substr(cut + 4);
  const auto found = Definitions().find(name);
  if (found == Definitions().end()) {
    throw std::invalid_argument("no definition of '" + type + "', expected one of those here");
  }
  std::string text = found->second.fields;
  for (const std::string& used : found->second.used) {
    text += std::string(80, '=') + "\nMSG: " + used + "\n" + Definitions().at(used).fields;
  }
  return text;
}

Bytes EncodeRos(const RosJointState& message) {
  RosEncoder out;
  out.Header(message.header);
  out.Put(static_cast<std::uint32_t>(message.names.size()));
  for (const std::string& name : message.names) out.Text(name);
  out.Sequence(message.positions);
  out.Sequence(message.velocities);
  out.Sequence(message.efforts);
  return out.Take();
}

Bytes EncodeRos(const RosImu& message) {
  RosEncoder out;
  out.Header(message.header);
  out.Fixed(message.orientation_xyzw);
  out.Fixed(kUnknownCovariance);
  out.Fixed(message.angular_velocity_rad_s);
  out.Fixed(kUnknownCovariance);
  out.Fixed(message.acceleration_m_s2);
  out.Fixed(kUnknownCovariance);
  return out.Take();
}

Bytes EncodeRos(const RosWrench& message) {
  RosEncoder out;
  out.Header(message.header);
  out.Fixed(message.force_N);
  out.Fixed(message.torque_Nm);
  return out.Take();
}

}  // namespace sinew::export_recording

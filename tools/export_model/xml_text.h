// Numbers, names and comments in XML. Pure; allocates.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <string>

namespace sinew::export_model {

// As many digits as give the number back exactly.
inline std::string ShortNumber(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

// The same; -0 is 0.
inline std::string XmlNumber(double value) { return ShortNumber(value == 0.0 ? 0.0 : value); }

inline std::string XmlNumbers(std::initializer_list<double> values) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "" : " ") + XmlNumber(value);
  return out;
}

inline std::string XmlVector(const Eigen::Vector3d& v) { return XmlNumbers({v.x(), v.y(), v.z()}); }

// Without the dashes that would end it.
inline std::string XmlComment(std::string text) {
  for (std::size_t at; (at = text.find("--")) != std::string::npos;) text.erase(at, 1);
  return "<!-- " + text + " -->";
}

// Fixed axes x, y, z (URDF, SDF): R = Rz(yaw) Ry(pitch) Rx(roll).
inline Eigen::Vector3d RollPitchYaw(const Eigen::Matrix3d& rotation) {
  const double pitch = std::atan2(-rotation(2, 0), std::hypot(rotation(2, 1), rotation(2, 2)));
  return {std::atan2(rotation(2, 1), rotation(2, 2)), pitch,
          std::atan2(rotation(1, 0), rotation(0, 0))};
}

}  // namespace sinew::export_model

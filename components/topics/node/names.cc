#include "components/topics/node/names.h"

#include <sstream>
#include <string_view>

namespace sinew::node::internal {

#ifdef SINEW_ROS2_NAMES

std::string RegisteredTopicName(const std::string& name) { return "rt/" + name; }

std::string RegisteredTypeName(const std::string& type_name, const std::string& /*idl_hash*/) {
  const std::size_t cut = type_name.rfind("::");
  return type_name.substr(0, cut) + "::dds_" + type_name.substr(cut) + "_";
}

#else

std::string RegisteredTopicName(const std::string& name) { return name; }

std::string RegisteredTypeName(const std::string& type_name, const std::string& idl_hash) {
  return type_name + "_" + idl_hash;
}

#endif

namespace {
constexpr std::string_view kJoints = "sinew-joints/1";
}

std::vector<std::uint8_t> JointNamesOnWire(const std::vector<std::string>& names) {
  std::string text(kJoints);
  for (const std::string& name : names) (text += '\0') += name;
  text += '\0';
  return {text.begin(), text.end()};
}

std::vector<std::string> JointNamesFromWire(const std::vector<std::uint8_t>& user_data) {
  std::istringstream text(std::string(user_data.begin(), user_data.end()));
  std::vector<std::string> names;
  for (std::string name; std::getline(text, name, '\0');) names.push_back(name);
  if (names.empty() || names.front() != kJoints) return {};
  names.erase(names.begin());
  return names;
}

}  // namespace sinew::node::internal

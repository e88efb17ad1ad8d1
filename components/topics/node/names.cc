#include "components/topics/node/names.h"

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

}  // namespace sinew::node::internal

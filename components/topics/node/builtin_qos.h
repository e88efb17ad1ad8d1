// qos_profiles.xml as it was when this was built.
#pragma once

#include <string_view>

namespace sinew::node {
std::string_view BuiltinQosXml();
}  // namespace sinew::node

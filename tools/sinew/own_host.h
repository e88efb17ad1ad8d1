// The name of this host, as component_status carries it.
#pragma once

#include <unistd.h>

#include <array>
#include <climits>
#include <string>

namespace sinew::tools {

inline std::string OwnHostName() {
  std::array<char, HOST_NAME_MAX + 1> name{};
  if (::gethostname(name.data(), name.size()) != 0) return {};
  return name.data();
}

}  // namespace sinew::tools

// The name of this host, as component_status carries it. Any thread.
#pragma once

#include <unistd.h>

#include <array>
#include <string>

namespace sinew::node {

// Empty: the system gives none.
inline std::string HostName() {
  std::array<char, 64> name{};  // Linux has at most 64 characters, of which the last is left out
  (void)::gethostname(name.data(), name.size() - 1);
  return name.data();
}

}  // namespace sinew::node

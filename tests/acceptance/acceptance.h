// How much the acceptance tests measure.
#pragma once

#include <cstdlib>
#include <string>

namespace sinew::acceptance {

// Part of the grids (some seconds a module), unless SINEW_ACCEPTANCE=full asks for all of them
// (minutes, with hours of simulated motion).
inline bool Quick() {
  const char* extent = std::getenv("SINEW_ACCEPTANCE");
  return extent == nullptr || std::string(extent) != "full";
}

}  // namespace sinew::acceptance

// Conditions on parameters. Throws std::invalid_argument. Not for the control cycle.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::types {

inline void Require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

// A value that is not finite never holds. "NAME: VALUE, expected EXPECTED".
inline void Require(bool holds, const std::string& name, double value, const char* expected) {
  Require(holds && std::isfinite(value),
          name + ": " + std::to_string(value) + ", expected " + expected);
}

}  // namespace sinew::types

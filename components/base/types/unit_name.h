// The unit at the end of a name: of keys, fields and columns.
#pragma once

#include <string>

namespace sinew::types {

struct UnitName {
  std::string stem;  // "viscous" of "viscous_Nm_s_rad"
  std::string unit;  // "Nm s/rad"; empty: the name has none
};

UnitName SplitUnit(const std::string& name);

}  // namespace sinew::types

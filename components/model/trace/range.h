// The catalogue's range of a parameter, applied to any machine: of a ratio all of it; of what has
// a unit the sign, since how large it may be is the machine's affair. Pure.
#pragma once

#include <limits>

#include "components/model/effects/effect.h"

namespace sinew::trace {

struct Range {
  double lower = 0.0, upper = 0.0;
};

inline Range RangeOnAnyMachine(const effects::ParameterInfo& info) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (info.dimension == effects::Dimension::kNone) return {info.lower, info.upper};
  return {info.lower >= 0.0 ? 0.0 : -kAny, info.upper <= 0.0 ? 0.0 : kAny};
}

}  // namespace sinew::trace

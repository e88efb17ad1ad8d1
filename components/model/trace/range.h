// The catalogue's range of a parameter, applied to any machine: of a ratio all of it; of what has
// a unit the sign, since how large it may be is the machine's affair. Pure.
#pragma once

#include <limits>
#include <span>

#include "components/model/actuator/model.h"
#include "components/model/effects/effect.h"
#include "components/model/identify/design.h"

namespace sinew::trace {

struct Range {
  double lower = 0.0, upper = 0.0;
};

inline Range RangeOnAnyMachine(const effects::ParameterInfo& info) {
  constexpr double kAny = std::numeric_limits<double>::infinity();
  if (info.dimension == effects::Dimension::kNone) return {info.lower, info.upper};
  return {info.lower >= 0.0 ? 0.0 : -kAny, info.upper <= 0.0 ? 0.0 : kAny};
}

// Range of parameter `linear` of an effect that is added to a model, in its unit. Where it has one
// and a declared term the same column (compliance of the teeth in free_play and gear_compliance),
// the two add up to one quantity: their sum is held to its range, the addition alone to none.
Range RangeOfAddition(const identify::Design& design, const actuator::JointModel& model,
                      const effects::Effect& effect, std::span<const double> psi,
                      std::size_t linear);

}  // namespace sinew::trace

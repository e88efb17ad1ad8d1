// The instruction set that runs an inner loop in the least time on this machine, by a measurement.
// All sets give the same bits, so the choice changes the speed only. The widest set is not always
// the fastest: docs/decisions/0011-vector-kernels.md.
#pragma once

#include <functional>

#include "components/base/simd/instructions.h"

namespace sinew::simd {

// `run(set)` runs the loop once with that set, and should take 1 to 30 us. It is called
// kFastestRounds times for each set that runs here, the sets in turn, and the set with the least
// time of a single run is returned: other processes can only make a run longer. Takes the time of
// all those runs, so it is for constructors and never for a loop that has a deadline. Callers keep
// the result in a static variable: a process measures a loop once. Throws what run throws.
inline constexpr int kFastestRounds = 16;
Instructions Fastest(const std::function<void(Instructions)>& run);

}  // namespace sinew::simd

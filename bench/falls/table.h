// What falls and squats came to: counts and times a kind, and whether the targets hold.
//
// Thread: one. SI units.
#pragma once

#include <iosfwd>
#include <vector>

#include "bench/falls/provoke.h"

namespace sinew::falls {

// A line each, with what was drawn and what came of it.
void Print(const FallRun& run, std::ostream& out);
void Print(const SquatRun& run, std::ostream& out);

// Falls a kind: how many, found, latency median and worst, joints as declared, the base's largest
// speed downwards. Squats a kind: how many, alarms.
// False: a fall that was not found in time, joints that were not in the declared state, an alarm in
// healthy squats.
bool PrintTable(const std::vector<FallRun>& falls, const std::vector<SquatRun>& squats,
                std::ostream& out);

}  // namespace sinew::falls

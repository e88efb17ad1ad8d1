// Regime of a SEA-PEA joint: whether the teeth of the gear are in contact. SEA, inside the
// backlash: the chamber alone carries the link. PEA: motor and chamber act in parallel.
#pragma once

#include <sinew_idl/regime.h>

namespace sinew::types {

using Regime = msg::RegimeKind;

}  // namespace sinew::types

// Regime of a SEA-PEA joint: whether the teeth of the gear are in contact.
#pragma once

namespace sinew::types {

enum class Regime {
  kUnknown,
  kSea,  // inside the backlash: the chamber alone carries the link
  kPea,  // teeth in contact: motor and chamber act in parallel
};

}  // namespace sinew::types

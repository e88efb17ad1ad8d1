#include "components/node/ownership.h"

#include <limits>

namespace sinew::node::internal {

namespace {

// The lowest strength of those that have settled; one above kFirstStrength where there is none.
Strength Lowest(std::span<const Rival> rivals) {
  Strength lowest = kFirstStrength + 1;
  for (const Rival& rival : rivals) {
    if (rival.strength > kJoiningStrength) lowest = std::min(lowest, rival.strength);
  }
  return lowest;
}

// Never back among those that join.
Strength OneBelow(Strength strength) { return std::max(strength - 1, kJoiningStrength + 1); }

}  // namespace

Strength StrengthBelow(Strength own, std::span<const Rival> rivals) {
  const Strength lowest = Lowest(rivals);
  return rivals.empty() || own < lowest ? own : OneBelow(lowest);
}

Strength StrengthAbove(Strength own, std::span<const Rival> rivals) {
  Strength highest = 0;
  for (const Rival& rival : rivals) highest = std::max(highest, rival.strength);
  if (own > highest && own > kJoiningStrength) return own;
  // Not next to those that join: others must fit in below.
  if (highest < kFirstStrength) return kFirstStrength;
  return highest < std::numeric_limits<Strength>::max() - 1 ? highest + 1 : highest;
}

Strength SettledStrength(std::span<const Rival> rivals) { return OneBelow(Lowest(rivals)); }

Strength StrengthWithoutTie(Strength own, const std::string& own_guid,
                            std::span<const Rival> rivals) {
  for (const Rival& rival : rivals) {
    if (rival.strength == own && rival.guid < own_guid) return OneBelow(Lowest(rivals));
  }
  return own;
}

}  // namespace sinew::node::internal

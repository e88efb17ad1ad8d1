#include "components/topics/node/ownership.h"

#include <limits>
#include <ratio>

namespace sinew::node::internal {

namespace {

// The lowest strength of those that have settled; above all where there is none.
Strength Lowest(std::span<const Rival> rivals) {
  Strength lowest = std::numeric_limits<Strength>::max();
  for (const Rival& rival : rivals) {
    if (rival.strength > kJoiningStrength) lowest = std::min(lowest, rival.strength);
  }
  return lowest;
}

// Never back among those that join.
Strength OneBelow(Strength strength) { return std::max(strength - 1, kJoiningStrength + 1); }

}  // namespace

Strength FirstStrength(std::chrono::system_clock::time_point started) noexcept {
  using std::chrono::sys_days, std::chrono::year, std::chrono::January;
  using Quarters = std::chrono::duration<std::int64_t, std::ratio<1, 4>>;
  constexpr sys_days kBegin = year(2024) / January / 1;
  const std::int64_t age = std::chrono::floor<Quarters>(started - kBegin).count();
  // Never among those that join, whatever the clock says.
  constexpr std::int64_t kMost = kGreatestFirstStrength - (1u << 20);
  return kGreatestFirstStrength - static_cast<Strength>(std::clamp<std::int64_t>(age, 0, kMost));
}

Strength StrengthBelow(Strength own, std::span<const Rival> rivals) {
  const Strength lowest = Lowest(rivals);
  return rivals.empty() || own < lowest ? own : OneBelow(lowest);
}

Strength StrengthAbove(Strength own, Strength first, std::span<const Rival> rivals) {
  Strength highest = 0;
  for (const Rival& rival : rivals) highest = std::max(highest, rival.strength);
  if (own > highest && own > kJoiningStrength) return own;
  // Not next to those that join: others must fit in below.
  if (highest < first) return first;
  return highest < std::numeric_limits<Strength>::max() - 1 ? highest + 1 : highest;
}

Strength SettledStrength(Strength first, std::span<const Rival> rivals) {
  return std::min(first, OneBelow(Lowest(rivals)));
}

Strength StrengthWithoutTie(Strength own, const std::string& own_guid,
                            std::span<const Rival> rivals) {
  for (const Rival& rival : rivals) {
    if (rival.strength == own && rival.guid < own_guid) return OneBelow(Lowest(rivals));
  }
  return own;
}

}  // namespace sinew::node::internal

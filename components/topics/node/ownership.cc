#include "components/topics/node/ownership.h"

#include <limits>
#include <ratio>

namespace sinew::node::internal {

namespace {

// No clock of an epoch shows an earlier time.
constexpr std::chrono::sys_days kBegin = std::chrono::year(2024) / std::chrono::January / 1;

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
  using Quarters = std::chrono::duration<std::int64_t, std::ratio<1, 4>>;
  const std::int64_t age = std::chrono::floor<Quarters>(started - kBegin).count();
  // Never among those that join, whatever the clock says.
  constexpr std::int64_t kMost = kGreatestFirstStrength - (1u << 20);
  return kGreatestFirstStrength - static_cast<Strength>(std::clamp<std::int64_t>(age, 0, kMost));
}

std::chrono::nanoseconds ClockOffset(std::int64_t stamp_ns,
                                     std::chrono::system_clock::time_point now) noexcept {
  const std::chrono::nanoseconds stamp(stamp_ns);
  if (stamp < kBegin.time_since_epoch()) return std::chrono::nanoseconds(0);
  const std::chrono::nanoseconds offset = stamp - now.time_since_epoch();
  return std::chrono::abs(offset) < std::chrono::seconds(1) ? std::chrono::nanoseconds(0) : offset;
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

bool Leads(Strength own, std::span<const Rival> rivals) {
  return own > kJoiningStrength && std::all_of(rivals.begin(), rivals.end(),
                                               [&](const Rival& r) { return r.strength < own; });
}

Strength StrengthWithoutTie(Strength own, const std::string& own_guid,
                            std::span<const Rival> rivals) {
  for (const Rival& rival : rivals) {
    if (rival.strength == own && rival.guid < own_guid) return OneBelow(Lowest(rivals));
  }
  return own;
}

}  // namespace sinew::node::internal

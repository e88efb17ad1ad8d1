// Ownership strengths of several writers of a topic, decided by rules: which of them is heard.
//
// A topic with EXCLUSIVE ownership has one writer at a time, the live one with the greatest
// strength; each reader decides that for itself, and drops a writer that was silent for Deadline.
// Of equal strengths Fast DDS hears the lower GUID, a matter of chance: strengths are therefore
// kept different, and change by these rules only:
//
//   a writer begins at kJoiningStrength, below every settled one: it never takes over from them;
//     of several that begin at the same time the lower GUID is heard until they settle
//   after kSettleTime it settles: at FirstStrength of its start when it knows of no settled one,
//     else below all, and never above FirstStrength: one started later is below an owner that
//     discovery has not found yet, with readers that have found both
//   two of one strength, started within a quarter of a second of each other: the one with the
//     higher GUID, which is not heard, goes below all
//   a writer that was silent for longer than the deadline while others were not goes below all,
//     before it writes again: a replaced one stays so; after a silence in which discovery may
//     have forgotten the others it joins anew; it is quiet until it has had time to be known as
//     that, or is above all others all the same: those were silent as well, or have ended, and
//     readers that wait for both would hear neither
//   a handover, the operator's command, puts the writer above all, once it has settled: before that
//     it may not hear yet what it computes its samples from
//
// A participant that is started again is a new writer: it joins below its successor.
//
// Pure; any thread.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>

namespace sinew::node::internal {

using Strength = std::uint32_t;

inline constexpr Strength kJoiningStrength = 1;

// Strength of a writer that was started then: a step less every quarter of a second since 2024,
// until 2040. Cyclone DDS has signed strengths: 2^31 is the limit, a million handovers above the
// greatest. All take the clock of the state provider's stamps where their own disagrees with it
// (ClockOffset), so that an owner that discovery has not found yet is not weaker than a newcomer
// with another clock. A clock that is set back makes a writer that starts later as old as it says.
inline constexpr Strength kGreatestFirstStrength = (1u << 31) - (1u << 20);
Strength FirstStrength(std::chrono::system_clock::time_point started) noexcept;

// The shift of an own time to be one of the provider's clock: nothing below a second, which the
// order of starts does not need, and nothing for a stamp from before 2024, which is of no epoch.
// stamp_ns: of its message that arrives now.
std::chrono::nanoseconds ClockOffset(std::int64_t stamp_ns,
                                     std::chrono::system_clock::time_point now) noexcept;

// A participant announces itself twice in this time (leaseAnnouncement of qos_profiles.xml) and
// answers newcomers at once: each writer is known by then, even if an announcement was lost.
inline constexpr std::chrono::milliseconds kSettleTime(1000);

// Silence after which others may have been forgotten: leaseDuration without leaseAnnouncement
// there.
inline constexpr std::chrono::milliseconds kForgottenAfter(2500);

// Silence after which a reader hears the next writer. Shorter than 20 ms it changes between healthy
// writers on a loaded machine (220 times in 20 s with 9 ms at 240 Hz), and a writer must be able to
// miss some cycles.
inline constexpr std::chrono::milliseconds kShortestDeadline(20);
inline constexpr int kDeadlinePeriods = 5;
constexpr std::chrono::nanoseconds Deadline(std::chrono::nanoseconds period) noexcept {
  return std::max<std::chrono::nanoseconds>(kShortestDeadline, kDeadlinePeriods * period);
}

// Another participant's writer of the same topic.
struct Rival {
  std::string guid;  // in Fast DDS' notation; the lower one is heard of equal strengths
  Strength strength = 0;
};

// first: FirstStrength of the writer's own start.
Strength StrengthBelow(Strength own, std::span<const Rival> rivals);
Strength StrengthAbove(Strength own, Strength first, std::span<const Rival> rivals);
// Strength of a writer whose time to settle is over.
Strength SettledStrength(Strength first, std::span<const Rival> rivals);
// Has settled, above all others.
bool Leads(Strength own, std::span<const Rival> rivals);
// Strength of a settled writer: below all when it has its strength in common with a lower GUID.
Strength StrengthWithoutTie(Strength own, const std::string& own_guid,
                            std::span<const Rival> rivals);

}  // namespace sinew::node::internal

namespace sinew::node {

// Whether a writer of this strength (Endpoint::strength) has settled. Until then nothing can be
// said about who is heard: an observer may know of the newcomer and not yet of the owner.
inline bool HasSettled(std::uint32_t strength) noexcept {
  return strength > internal::kJoiningStrength;
}

}  // namespace sinew::node

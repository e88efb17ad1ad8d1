// The rules by which strengths change, and a law: whatever joins, is silent or comes back, the
// owner changes only when it has been silent, or by a handover.
#include "components/topics/node/ownership.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <random>
#include <vector>

namespace sinew::node::internal {
namespace {

using namespace std::chrono_literals;

constexpr Strength kFirst = 1000000;

TEST(Ownership, TheFirstOneSettlesAtTheStrengthOfItsStart) {
  EXPECT_EQ(SettledStrength(kFirst, {}), kFirst);
  const std::vector<Rival> joining = {{"b", kJoiningStrength}};
  EXPECT_EQ(SettledStrength(kFirst, joining), kFirst);
}

TEST(Ownership, WhoComesLaterSettlesBelowAll) {
  const std::vector<Rival> rivals = {{"a", kFirst}, {"b", kFirst - 4}};
  EXPECT_EQ(SettledStrength(kFirst, rivals), kFirst - 5);
  EXPECT_LT(kJoiningStrength, SettledStrength(kFirst, rivals));
}

TEST(Ownership, WhoIsStartedLaterAndFindsNobodyIsBelowTheOwnerAllTheSame) {
  using std::chrono::system_clock;
  const system_clock::time_point start = std::chrono::sys_days(std::chrono::year(2027) / 3 / 4);
  for (const auto later : {250ms, 1000ms, 3600000ms}) {
    EXPECT_LT(SettledStrength(FirstStrength(start + later), {}),
              SettledStrength(FirstStrength(start), {}))
        << later.count() << " ms";
  }
  EXPECT_EQ(FirstStrength(start) - FirstStrength(start + 1h), 4u * 3600u);
  const std::vector<Rival> known = {{"b", 500}};
  EXPECT_EQ(SettledStrength(FirstStrength(start), known), 499u) << "of known ones below all";
  // Before the rule's time and after it: still settled, still below Cyclone DDS' limit.
  for (const int year : {1970, 2023, 2041, 2200}) {
    const Strength strength = FirstStrength(std::chrono::sys_days(std::chrono::year(year) / 1 / 1));
    EXPECT_GT(strength, kJoiningStrength + (1u << 19)) << year;
    EXPECT_LT(strength, (1u << 31) - (1u << 19)) << year;
  }
}

TEST(Ownership, OfTwoThatSettledTogetherTheHigherGuidGoesBelow) {
  const std::vector<Rival> lower = {{"01.0f|1", kFirst}}, higher = {{"01.1f|1", kFirst}};
  EXPECT_EQ(StrengthWithoutTie(kFirst, "01.1f|1", lower), kFirst - 1);
  EXPECT_EQ(StrengthWithoutTie(kFirst, "01.0f|1", higher), kFirst);
}

TEST(Ownership, WhoWasSilentGoesBelowAllButStaysWhereItIsAlone) {
  const std::vector<Rival> rivals = {{"b", 90}, {"c", 80}};
  EXPECT_EQ(StrengthBelow(100, rivals), 79u);
  EXPECT_EQ(StrengthBelow(70, rivals), 70u) << "it was below them already";
  EXPECT_EQ(StrengthBelow(100, {}), 100u);
}

TEST(Ownership, WhoIsAboveAllOthersLeads) {
  EXPECT_TRUE(Leads(8, std::vector<Rival>{{"a", 7}, {"b", kJoiningStrength}}));
  EXPECT_TRUE(Leads(8, {})) << "the others have ended";
  EXPECT_FALSE(Leads(8, std::vector<Rival>{{"a", 9}}));
  EXPECT_FALSE(Leads(8, std::vector<Rival>{{"a", 8}})) << "the GUID decides, which is chance";
  EXPECT_FALSE(Leads(kJoiningStrength, {})) << "it has not settled";
}

TEST(Ownership, AHandoverPutsItAboveAll) {
  const std::vector<Rival> rivals = {{"b", 90}, {"c", 80}};
  EXPECT_EQ(StrengthAbove(70, kFirst, rivals), kFirst) << "others must fit in below";
  EXPECT_EQ(StrengthAbove(91, kFirst, rivals), 91u) << "a repeated command changes nothing";
  EXPECT_EQ(StrengthAbove(70, kFirst, {}), 70u);
  const std::vector<Rival> settled = {{"b", kFirst}}, joining = {{"b", kJoiningStrength}};
  EXPECT_EQ(StrengthAbove(70, kFirst, settled), kFirst + 1);
  EXPECT_EQ(StrengthAbove(kJoiningStrength, kFirst, joining), kFirst);
  EXPECT_EQ(StrengthAbove(kJoiningStrength, kFirst, {}), kFirst);
}

TEST(Ownership, StrengthsNeverReachThoseOfJoiningWritersOrOfSharedTopics) {
  const std::vector<Rival> low = {{"b", kJoiningStrength + 1}};
  EXPECT_GT(StrengthBelow(100, low), kJoiningStrength);
  EXPECT_GT(SettledStrength(kFirst, low), kJoiningStrength);
  const std::vector<Rival> high = {{"b", ~Strength{0} - 1}};
  EXPECT_LT(StrengthAbove(1, kFirst, high), ~Strength{0})
      << "Fast DDS reads that as a shared topic's";
}

TEST(Ownership, TheDeadlineIsFivePeriodsAndAtLeastTwentyMilliseconds) {
  EXPECT_EQ(Deadline(1ms), 20ms);
  EXPECT_EQ(Deadline(4ms), 20ms);
  EXPECT_EQ(Deadline(10ms), 50ms);
}

// A reader as Fast DDS is one: the live writer of the greatest strength, of equal ones the lower
// GUID.
struct Candidate {
  std::string guid;
  Strength first = 0;
  Strength strength = kJoiningStrength;
  bool alive = true;
  bool settled = false;
};

std::vector<Rival> RivalsOf(const std::vector<Candidate>& all, std::size_t own) {
  std::vector<Rival> rivals;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i != own) rivals.push_back({all[i].guid, all[i].strength});
  }
  return rivals;
}

std::optional<std::string> Heard(const std::vector<Candidate>& all) {
  const Candidate* heard = nullptr;
  for (const Candidate& one : all) {
    if (!one.alive) continue;
    if (heard == nullptr || one.strength > heard->strength ||
        (one.strength == heard->strength && one.guid < heard->guid)) {
      heard = &one;
    }
  }
  return heard == nullptr ? std::nullopt : std::optional(heard->guid);
}

TEST(Ownership, TheOwnerChangesOnlyWhenItIsSilentOrByAHandover) {
  std::mt19937 random(5);
  for (int sequence = 0; sequence < 2000; ++sequence) {
    std::vector<Candidate> all;
    int age = 0;
    const auto join = [&] {
      Candidate one;
      one.first = kFirst - static_cast<Strength>(++age * 100);  // each 25 s after the last
      one.guid = std::to_string(100000 + random() % 900000);
      all.push_back(one);
    };
    join();
    all[0].strength = SettledStrength(all[0].first, {});
    all[0].settled = true;
    for (int event = 0; event < 30; ++event) {
      const auto before = Heard(all);
      // Those that have not settled are heard by their GUIDs while nobody else lives.
      const bool provisional = std::none_of(
          all.begin(), all.end(), [](const Candidate& one) { return one.alive && one.settled; });
      const std::size_t i = random() % all.size();
      bool may_change = false;
      switch (random() % 5) {
        case 0:
          if (all.size() < 6) join();
          break;
        case 1: {  // all take the same time to settle: the one that was started first
          const auto next = std::find_if(all.begin(), all.end(),
                                         [](const Candidate& one) { return !one.settled; });
          if (next == all.end()) break;
          const auto at = static_cast<std::size_t>(next - all.begin());
          // Discovery may not have found anybody yet.
          const bool knows = random() % 3 != 0;
          next->settled = true;
          next->strength =
              SettledStrength(next->first, knows ? RivalsOf(all, at) : std::vector<Rival>{});
          break;
        }
        case 2:  // silent, or killed
          all[i].alive = false;
          may_change = before == all[i].guid;
          break;
        case 3:  // comes back
          if (!all[i].alive) {
            all[i].strength =
                all[i].settled ? StrengthBelow(all[i].strength, RivalsOf(all, i)) : all[i].strength;
            all[i].alive = true;
          }
          break;
        case 4:
          if (all[i].alive && all[i].settled) {
            all[i].strength = StrengthAbove(all[i].strength, all[i].first, RivalsOf(all, i));
            EXPECT_EQ(Heard(all), all[i].guid) << "the handover did not work";
            may_change = true;
          }
          break;
      }
      if (!may_change && !provisional) {
        ASSERT_EQ(Heard(all), before) << "sequence " << sequence;
      }
    }
  }
}

TEST(Ownership, AClockCountsAsTheProvidersOnceItIsASecondOff) {
  const std::chrono::system_clock::time_point now(1'900'000'000s);
  const auto stamp = [&](std::chrono::nanoseconds ahead) {
    return std::chrono::nanoseconds(now.time_since_epoch() + ahead).count();
  };
  EXPECT_EQ(ClockOffset(stamp(-900ms), now), 0ns) << "a message's delay, and clocks that agree";
  EXPECT_EQ(ClockOffset(stamp(1h), now), 1h);
  EXPECT_EQ(ClockOffset(stamp(-1h), now), -1h);
  EXPECT_EQ(ClockOffset(5'000'000'000, now), 0ns) << "simulated time";
  // A newcomer whose clock is an hour behind is weaker than an owner of ten minutes all the same.
  const auto owner = now - 10min, newcomer = now - 1h;
  EXPECT_GT(FirstStrength(newcomer), FirstStrength(owner));
  EXPECT_LT(FirstStrength(newcomer + ClockOffset(stamp(0s), newcomer)), FirstStrength(owner));
}

}  // namespace
}  // namespace sinew::node::internal

#include "sim/body_disturbance/schedule.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "components/base/config/config.h"
#include "sim/body_disturbance/file/schedule_file.h"

namespace sinew::body_disturbance {
namespace {

constexpr double kSchedulePeriod_s = 1.0 / 240.0;

Payload Load(double at_s, double until_s, double mass_kg = 4.0) {
  return {.when = {at_s, until_s}, .link = "torso", .mass_kg = mass_kg, .place_m = {0.1, 0, 0.2}};
}

Push Shove(double at_s, double until_s) {
  return {.when = {at_s, until_s}, .link = "pelvis", .force_N = {60, 0, 0}, .place_m = {0, 0, 0.1}};
}

TEST(Schedule, WithoutEntriesNothingActs) {
  EXPECT_EQ(Schedule({}, {}).At(1000, kSchedulePeriod_s), provider::BodyDisturbance{});
}

TEST(Schedule, AnEntryActsFromItsTickToTheOneBeforeItsEnd) {
  const Schedule schedule({Load(18.5, 20.0)}, {Shove(5.0, 5.1)});
  const auto at = [&](std::uint64_t tick) { return schedule.At(tick, kSchedulePeriod_s); };
  EXPECT_EQ(at(4439).payload_kg, 0.0);
  EXPECT_EQ(at(4440).payload_kg, 4.0) << "18.5 s of 240 Hz";
  EXPECT_EQ(at(4440).payload_link, "torso");
  EXPECT_EQ(at(4440).payload_m, (std::array{0.1, 0.0, 0.2}));
  EXPECT_EQ(at(4799).payload_kg, 4.0);
  EXPECT_EQ(at(4800), provider::BodyDisturbance{});
  EXPECT_EQ(at(1199), provider::BodyDisturbance{});
  EXPECT_EQ(at(1200).push_force_N, (std::array{60.0, 0.0, 0.0}));
  EXPECT_EQ(at(1200).push_link, "pelvis");
  EXPECT_EQ(at(1200).push_m, (std::array{0.0, 0.0, 0.1}));
  EXPECT_EQ(at(1223).push_force_N[0], 60.0);
  EXPECT_EQ(at(1224), provider::BodyDisturbance{});
}

// Whatever period and begin: an entry of n periods acts in n ticks, and entries that follow each
// other leave no tick between them.
TEST(Schedule, EntriesThatFollowEachOtherLeaveNoGap) {
  for (const double rate_Hz : {82.0, 240.0, 457.0, 1000.0}) {
    const Schedule schedule({Load(0.1, 0.37, 1.0), Load(0.37, kForEver_s, 2.0)}, {});
    double last_kg = 0.0;
    for (std::uint64_t tick = 0; tick < 1000; ++tick) {
      const double now_kg = schedule.At(tick, 1.0 / rate_Hz).payload_kg;
      EXPECT_GE(now_kg, last_kg) << rate_Hz << " Hz, tick " << tick;
      last_kg = now_kg;
    }
    EXPECT_EQ(last_kg, 2.0);
  }
}

TEST(Schedule, WhatCannotActIsRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Schedule({Load(-1.0, 2.0)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({Load(2.0, 2.0)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({Load(nan, 2.0)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({Load(0.0, 2.0, -1.0)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({Load(0.0, 2.0, nan)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({Load(3.0, 4.0), Load(0.0, 3.5)}, {}), std::invalid_argument);
  EXPECT_THROW(Schedule({}, {Shove(0.0, kForEver_s), Shove(9.0, 9.5)}), std::invalid_argument);
  EXPECT_NO_THROW(Schedule({Load(3.0, 4.0)}, {Shove(3.0, 4.0)})) << "a load and a push at a time";
  EXPECT_THROW(Schedule({}, {}, {{{1.0, 3.0}, "knee"}, {{2.0, 4.0}, "hip"}}),
               std::invalid_argument);
  EXPECT_THROW(Schedule({}, {}, {}, {{{1.0, 3.0}, 1.1}}), std::invalid_argument);
  EXPECT_THROW(Schedule({}, {}, {}, {{{1.0, 3.0}, -0.1}}), std::invalid_argument);
  EXPECT_THROW(Schedule({}, {}, {}, {{{1.0, 3.0}, nan}}), std::invalid_argument);
}

config::Section ScheduleText(const std::string& text) {
  return config::Section::Parse("schema: sinew-body-disturbance/1\n" + text, "load.yaml",
                                "sinew-body-disturbance/1");
}

TEST(ScheduleFile, HoldsEntriesWithLoadPushOrBoth) {
  const Schedule schedule = ReadSchedule(ScheduleText(
      "disturbances:\n"
      "  - {at_s: 1, payload: {link: torso, mass_kg: 4, place_m: [0.1, 0, 0.2]}}\n"
      "  - {at_s: 2, for_s: 0.5, push: {link: pelvis, force_N: [1, 2, 3], place_m: [4, 5, 6]}}\n"));
  const provider::BodyDisturbance both = schedule.At(2 * 240, kSchedulePeriod_s);
  EXPECT_EQ(both.payload_link, "torso");
  EXPECT_EQ(both.payload_kg, 4.0);
  EXPECT_EQ(both.payload_m, (std::array{0.1, 0.0, 0.2}));
  EXPECT_EQ(both.push_link, "pelvis");
  EXPECT_EQ(both.push_force_N, (std::array{1.0, 2.0, 3.0}));
  EXPECT_EQ(both.push_m, (std::array{4.0, 5.0, 6.0}));
  const provider::BodyDisturbance later = schedule.At(1'000'000, kSchedulePeriod_s);
  EXPECT_EQ(later.payload_kg, 4.0) << "without for_s it stays";
  EXPECT_EQ(later.push_force_N[0], 0.0);
}

TEST(ScheduleFile, TakesDrivesAndFrictionAway) {
  const Schedule schedule =
      ReadSchedule(ScheduleText("disturbances:\n"
                                "  - {at_s: 1, lost_drive: left_knee}\n"
                                "  - {at_s: 2, for_s: 0.5, lost_friction: 0.95}\n"));
  EXPECT_EQ(schedule.At(239, kSchedulePeriod_s), provider::BodyDisturbance{});
  EXPECT_EQ(schedule.At(240, kSchedulePeriod_s).lost_drive, "left_knee");
  EXPECT_EQ(schedule.At(240, kSchedulePeriod_s).lost_friction, 0.0);
  EXPECT_EQ(schedule.At(480, kSchedulePeriod_s).lost_friction, 0.95);
  EXPECT_EQ(schedule.At(600, kSchedulePeriod_s).lost_friction, 0.0);
  EXPECT_EQ(schedule.At(600, kSchedulePeriod_s).lost_drive, "left_knee") << "for good";
}

TEST(ScheduleFile, NamesLineAndKeyOfWhatIsWrong) {
  const auto error_of = [](const std::string& entry) -> std::string {
    try {
      (void)ReadSchedule(ScheduleText("disturbances:\n  - " + entry + "\n"));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(error_of("{at_s: 1}"),
              HasSubstr("expected payload, push, lost_drive or lost_friction"));
  EXPECT_THAT(error_of("{at_s: 1, payload: {link: a, mass_kg: 4, place_m: [0, 0]}}"),
              HasSubstr("2 numbers, expected x, y, z"));
  EXPECT_THAT(error_of("{at_s: 1, payload: {link: a, mass_g: 4, place_m: [0, 0, 0]}}"),
              HasSubstr("mass_kg"));
  EXPECT_THAT(error_of("{at_s: 1, payload: {link: " + std::string(65, 'a') +
                       ", mass_kg: 4, place_m: [0, 0, 0]}}"),
              HasSubstr("1 to 64 characters"));
  EXPECT_THAT(error_of("{at_s: 1, lost_friction: 1.5}"), HasSubstr("lost_friction"));
  EXPECT_THAT(error_of("{at_s: 1, lost_drive: ''}"), HasSubstr("1 to 64 characters"));
  EXPECT_THAT(error_of("{at_s: 1, weight: 2, payload: {link: a, mass_kg: 4, place_m: [0, 0, 0]}}"),
              HasSubstr("weight"));
}

TEST(ScheduleFile, OfTheBipedPutsFourKilogramsOnAtTheEndOfTheThirdSquat) {
  const Schedule schedule = LoadSchedule(SINEW_SOURCE_DIR "/robots/biped/payload.yaml");
  const auto at_s = [&](double time_s) {
    return schedule.At(static_cast<std::uint64_t>(time_s * 240.0), kSchedulePeriod_s).payload_kg;
  };
  EXPECT_EQ(at_s(18.49), 0.0);
  EXPECT_EQ(at_s(18.51), 4.0);
  EXPECT_EQ(at_s(40.0), 4.0);
}

}  // namespace
}  // namespace sinew::body_disturbance

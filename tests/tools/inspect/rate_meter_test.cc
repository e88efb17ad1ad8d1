#include "tools/inspect/rate_meter.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew::inspect {
namespace {

constexpr std::int64_t kEpoch_ns = 1'800'000'000'000'000'000;  // a day in 2027
constexpr std::int64_t kStep_ns = 4'000'000;

// Message of tick k of a topic of 250 Hz that arrives 1 ms after its stamp.
Arrival At(std::uint64_t tick, std::int64_t late_ns = 0) {
  const std::int64_t stamp = kEpoch_ns + static_cast<std::int64_t>(tick) * kStep_ns;
  return {stamp + 1'000'000 + late_ns, stamp + 500'000, stamp, 7, tick, false};
}

TEST(RateMeter, ARegularTopicHasItsRateAndNoJitter) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick <= 1000; ++tick) meter.Add(At(tick));
  const RateSummary summary = meter.Summary();
  EXPECT_EQ(summary.messages, 1001u);
  EXPECT_NEAR(*summary.rate_Hz, 250.0, 1e-9);
  EXPECT_NEAR(summary.interval_ms->mean, 4.0, 1e-9);
  EXPECT_NEAR(summary.interval_ms->deviation, 0.0, 1e-9);
  EXPECT_NEAR(summary.age_ms->mean, 1.0, 1e-9);
  EXPECT_NEAR(summary.delay_ms->largest, 0.5, 1e-9);
  EXPECT_EQ(summary.lost, 0u);
  EXPECT_EQ(summary.tick_step, 1u);
  EXPECT_EQ(summary.sessions, 1u);
}

TEST(RateMeter, ABurstThatIsLongOverHasNoRate) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick <= 10; ++tick) meter.Add(At(tick));
  const std::int64_t last_ns = At(10).arrival_ns, spoke_ns = 10 * kStep_ns;
  EXPECT_NEAR(*meter.Summary().rate_Hz, 250.0, 1e-9);
  EXPECT_TRUE(meter.Summary(last_ns + spoke_ns).rate_Hz.has_value());
  EXPECT_FALSE(meter.Summary(last_ns + spoke_ns + 1).rate_Hz.has_value());
  EXPECT_EQ(meter.Summary(last_ns + spoke_ns + 1).messages, 11u);
}

TEST(RateMeter, AMessageFromHistoryIsCountedAndNothingElse) {
  RateMeter meter;
  Arrival old = At(0, 60'000'000'000);
  old.from_history = true;
  meter.Add(old);
  EXPECT_EQ(meter.Summary().messages, 1u);
  EXPECT_FALSE(meter.Summary().age_ms || meter.Summary().delay_ms || meter.Summary().rate_Hz);
  for (std::uint64_t tick = 100; tick <= 110; ++tick) meter.Add(At(tick));
  EXPECT_EQ(meter.Summary().messages, 12u);
  EXPECT_NEAR(*meter.Summary().rate_Hz, 250.0, 1e-9);
  EXPECT_NEAR(meter.Summary().age_ms->largest, 1.0, 1e-9);
  EXPECT_EQ(meter.Summary().lost, 0u);
}

TEST(RateMeter, WithoutTicksNothingIsLostAndSessionsCount) {
  RateMeter meter;
  for (std::uint64_t k = 0; k < 5; ++k) {
    Arrival arrival = At(240 * k);
    arrival.tick.reset();
    arrival.session_id = k < 3 ? 7 : 8;
    meter.Add(arrival);
  }
  EXPECT_FALSE(meter.Summary().lost.has_value());
  EXPECT_EQ(meter.Summary().repeated, 0u);
  EXPECT_EQ(meter.Summary().sessions, 2u);
}

TEST(RateMeter, JitterIsTheStandardDeviationOfTheIntervals) {
  RateMeter meter;
  // Every other message is 1 ms late: intervals of 5 and 3 ms.
  for (std::uint64_t tick = 0; tick < 1001; ++tick) meter.Add(At(tick, tick % 2 * 1'000'000));
  const RateSummary summary = meter.Summary();
  EXPECT_NEAR(summary.interval_ms->deviation, 1.0, 1e-6);
  EXPECT_NEAR(summary.interval_ms->least, 3.0, 1e-9);
  EXPECT_NEAR(summary.interval_ms->largest, 5.0, 1e-9);
  EXPECT_NEAR(summary.age_ms->largest, 2.0, 1e-9);
}

TEST(RateMeter, GapsOfTicksAreLostMessages) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick < 100; ++tick) {
    if (tick % 10 != 3 && tick != 50 && tick != 51) meter.Add(At(tick));
  }
  EXPECT_EQ(meter.Summary().lost, 12u);
  EXPECT_NEAR(*meter.Summary().lost_share, 0.12, 1e-12);
}

TEST(RateMeter, ATopicOfEverySixteenthTickHasThatStep) {
  RateMeter meter;
  for (std::uint64_t k = 0; k < 100; ++k) {
    if (k != 40) meter.Add(At(16 * k));
  }
  EXPECT_EQ(meter.Summary().tick_step, 16u);
  EXPECT_EQ(meter.Summary().lost, 1u);
}

TEST(RateMeter, OfIrregularTopicsNothingIsSaidToBeLost) {
  RateMeter meter;
  std::uint64_t tick = 0;
  for (std::uint64_t step = 1; step < 40; ++step) meter.Add(At(tick += step));
  EXPECT_EQ(meter.Summary().lost, std::nullopt);
}

TEST(RateMeter, TwoWritersAreTicksThatComeAgain) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick < 50; ++tick) {
    meter.Add(At(tick));
    meter.Add(At(tick, 1000));
  }
  EXPECT_EQ(meter.Summary().repeated, 50u);
  EXPECT_EQ(meter.Summary().lost, 0u);
}

TEST(RateMeter, ANewSessionIsNoGap) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick < 10; ++tick) meter.Add(At(tick));
  for (std::uint64_t tick = 1000; tick < 1010; ++tick) {
    Arrival arrival = At(tick);
    arrival.session_id = 8;
    meter.Add(arrival);
  }
  EXPECT_EQ(meter.Summary().sessions, 2u);
  EXPECT_EQ(meter.Summary().lost, 0u);
}

TEST(RateMeter, SimulatedTimeAndReplaysHaveNoAge) {
  RateMeter simulated, replayed;
  for (std::uint64_t tick = 0; tick < 10; ++tick) {
    Arrival arrival = At(tick);
    arrival.stamp_ns = static_cast<std::int64_t>(tick) * kStep_ns;
    simulated.Add(arrival);
    arrival = At(tick);
    arrival.is_replay = true;
    replayed.Add(arrival);
  }
  EXPECT_FALSE(simulated.Summary().age_ms.has_value());
  EXPECT_FALSE(replayed.Summary().age_ms.has_value());
}

TEST(RateMeter, NothingAndOneMessageHaveNoRate) {
  RateMeter meter;
  EXPECT_EQ(meter.Summary().messages, 0u);
  EXPECT_FALSE(meter.Summary().rate_Hz.has_value());
  meter.Add(At(5));
  EXPECT_FALSE(meter.Summary().rate_Hz.has_value());
  EXPECT_FALSE(meter.Summary().interval_ms.has_value());
  EXPECT_FALSE(meter.Summary().lost.has_value());
}

TEST(RateMeter, AMillionMessagesKeepTheirFigures) {
  RateMeter meter;
  for (std::uint64_t tick = 0; tick < 1'000'000; ++tick) {
    if (tick % 1000 != 999) meter.Add(At(tick, tick % 2 * 1'000'000));
  }
  const RateSummary summary = meter.Summary();
  EXPECT_EQ(summary.lost, 999u) << "the last gap has no end";
  EXPECT_NEAR(*summary.rate_Hz, 249.75, 0.001);
}

}  // namespace
}  // namespace sinew::inspect

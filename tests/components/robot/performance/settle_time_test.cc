// Settle times against those of an exponential and of an oscillation.
#include "components/robot/performance/settle_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>

namespace sinew::performance {
namespace {

constexpr double kSettlePeriod_s = 1.0 / 240.0;
using SettleState = SettleResult::State;

SettleConfig Band(double band, std::optional<double> plateau, double hold_s = 1.0) {
  return SettleConfig{.band = band, .hold_s = hold_s, .plateau = plateau};
}

template <class Signal>
SettleResult Feed(SettleTime* settle, std::uint64_t from, std::uint64_t to, const Signal& signal) {
  SettleResult result;
  for (std::uint64_t tick = from; tick <= to; ++tick) {
    result = settle->Step(tick, signal(static_cast<double>(tick) * kSettlePeriod_s));
  }
  return result;
}

TEST(SettleTime, OfADecayToAGivenPlateauIsTheLogarithm) {
  SettleTime settle(Band(0.05, 0.2), kSettlePeriod_s);
  settle.Event(0);
  const auto decay = [](double t_s) { return 0.2 + 2.0 * std::exp(-t_s / 0.3); };
  const SettleResult result = Feed(&settle, 0, 1200, decay);
  EXPECT_EQ(result.state, SettleState::kSettled);
  EXPECT_NEAR(result.settle_s, 0.3 * std::log(2.0 / 0.05), kSettlePeriod_s);
  EXPECT_EQ(result.plateau, 0.2);
  EXPECT_EQ(result.departures, 0);
}

TEST(SettleTime, WithoutAPlateauComesEarlyByWhatTheHeaderStates) {
  for (const double ratio : {5.0, 10.0}) {
    const double decay_s = 0.3;
    SettleTime settle(Band(0.02, std::nullopt, ratio * decay_s), kSettlePeriod_s);
    settle.Event(0);
    const SettleResult result =
        Feed(&settle, 0, 2400, [&](double t_s) { return 1.0 + 2.0 * std::exp(-t_s / decay_s); });
    const double early_s = decay_s * std::log(1.0 / (1.0 - (1.0 - std::exp(-ratio)) / ratio));
    EXPECT_EQ(result.state, SettleState::kSettled);
    EXPECT_NEAR(result.settle_s, decay_s * std::log(2.0 / 0.02) - early_s, 3.0 * kSettlePeriod_s);
    EXPECT_NEAR(result.plateau, 1.0, 0.02);
  }
}

// Crossing the band is not settling: |A exp(-t/T) cos| stays within it after the envelope's last
// half-wave above the band.
TEST(SettleTime, OfAnOscillationIsThatOfItsLastHalfWaveAboveTheBand) {
  const auto signal = [](double t_s) {
    return std::exp(-t_s / 0.5) * std::cos(2.0 * std::numbers::pi * 2.0 * t_s);
  };
  double expected_s = 0.0;
  for (int i = 0; i < 1200; ++i) {
    if (std::abs(signal(i * kSettlePeriod_s)) > 0.1) expected_s = (i + 1) * kSettlePeriod_s;
  }
  SettleTime settle(Band(0.1, 0.0), kSettlePeriod_s);
  settle.Event(0);
  const SettleResult result = Feed(&settle, 0, 1200, signal);
  EXPECT_EQ(result.state, SettleState::kSettled);
  EXPECT_NEAR(result.settle_s, expected_s, 1e-12);
}

TEST(SettleTime, IsKnownAHoldAfterTheSignalHasSettled) {
  SettleTime settle(Band(0.1, 0.0, 0.5), kSettlePeriod_s);
  settle.Event(240);
  EXPECT_EQ(Feed(&settle, 240, 359, [](double) { return 0.0; }).state, SettleState::kNotSettled);
  const SettleResult result = settle.Step(360, 0.0);
  EXPECT_EQ(result.state, SettleState::kSettled);
  EXPECT_EQ(result.settle_s, 0.0);
}

TEST(SettleTime, IsWithdrawnWhenTheSignalLeavesAndTheLastOneCounts) {
  for (const std::optional<double> plateau :
       {std::optional<double>(0.0), std::optional<double>()}) {
    SettleTime settle(Band(0.1, plateau, 0.5), kSettlePeriod_s);
    settle.Event(0);
    EXPECT_EQ(Feed(&settle, 0, 200, [](double) { return 0.0; }).state, SettleState::kSettled);
    EXPECT_EQ(settle.Step(201, 0.5).state, SettleState::kNotSettled);
    const SettleResult result = Feed(&settle, 202, 500, [](double) { return 0.01; });
    EXPECT_EQ(result.state, SettleState::kSettled);
    EXPECT_EQ(result.departures, 1);
    EXPECT_NEAR(result.settle_s, 202 * kSettlePeriod_s, 1e-12);
  }
}

TEST(SettleTime, NeverSettlesOnARampThatLeavesTheBandWithinTheHold) {
  SettleTime settle(Band(0.1, std::nullopt, 1.0), kSettlePeriod_s);
  settle.Event(0);
  EXPECT_EQ(Feed(&settle, 0, 24000, [](double t_s) { return 0.3 * t_s; }).state,
            SettleState::kNotSettled);
}

TEST(SettleTime, CountsLostSamplesAndSearchesAnewAfterALongGap) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  SettleTime shortly(Band(0.1, 0.0, 0.5), kSettlePeriod_s);
  shortly.Event(0);
  Feed(&shortly, 0, 59, [](double) { return 0.0; });
  shortly.Step(60, nan);
  const SettleResult bridged = Feed(&shortly, 65, 140, [](double) { return 0.0; });
  EXPECT_EQ(bridged.state, SettleState::kSettled);
  EXPECT_EQ(bridged.lost_ticks, 5u);
  EXPECT_EQ(bridged.settle_s, 0.0);

  for (const std::optional<double> plateau :
       {std::optional<double>(0.0), std::optional<double>()}) {
    SettleTime settle(Band(0.1, plateau, 0.5), kSettlePeriod_s);
    settle.Event(0);
    Feed(&settle, 0, 59, [](double) { return 0.0; });
    const SettleResult result = Feed(&settle, 100, 300, [](double) { return 0.0; });
    EXPECT_EQ(result.state, SettleState::kSettled);
    EXPECT_EQ(result.lost_ticks, 40u);
    EXPECT_NEAR(result.settle_s, 100 * kSettlePeriod_s, 1e-12);
  }
}

TEST(SettleTime, KnowsNothingBeforeAnEventAndForgetsAtTheNext) {
  SettleTime settle(Band(0.1, 0.0, 0.5), kSettlePeriod_s);
  EXPECT_EQ(settle.Step(0, 0.0).state, SettleState::kNoEvent);
  settle.Event(10);
  EXPECT_EQ(settle.Step(5, 0.0).state, SettleState::kNotSettled);  // before the event
  Feed(&settle, 10, 400, [](double) { return 0.0; });
  settle.Event(401);
  EXPECT_EQ(settle.Step(401, 1.0).state, SettleState::kNotSettled);
}

TEST(SettleTime, RefusesFiguresOutOfRange) {
  EXPECT_THROW(SettleTime(Band(0.0, 0.0), kSettlePeriod_s), std::invalid_argument);
  EXPECT_THROW(SettleTime(Band(0.1, std::nan("")), kSettlePeriod_s), std::invalid_argument);
  EXPECT_THROW(SettleTime(Band(0.1, 0.0, 0.0), kSettlePeriod_s), std::invalid_argument);
  EXPECT_THROW(SettleTime(Band(0.1, 0.0, 0.06), kSettlePeriod_s), std::invalid_argument);
  EXPECT_THROW(SettleTime(Band(0.1, 0.0), 0.0), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::performance

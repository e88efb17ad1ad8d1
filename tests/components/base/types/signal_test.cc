#include "components/base/types/signal.h"

#include <gtest/gtest.h>

#include <bit>
#include <set>
#include <stdexcept>
#include <string>

namespace sinew::types {
namespace {

TEST(Signal, EverySignalIsListedOnceInTheOrderOfItsNumber) {
  ASSERT_EQ(AllSignals().size(), kSignalCount);
  for (std::size_t i = 0; i < kSignalCount; ++i) {
    EXPECT_EQ(static_cast<std::size_t>(AllSignals()[i]), i);
  }
}

TEST(Signal, NamesAreDistinctAndLeadBackToTheSignal) {
  std::set<std::string_view> names;
  for (const Signal signal : AllSignals()) {
    EXPECT_TRUE(names.insert(SignalName(signal)).second) << SignalName(signal);
    EXPECT_EQ(SignalFromName(SignalName(signal)), signal) << SignalName(signal);
  }
}

TEST(Signal, UnknownNamesHaveNoSignal) {
  for (const char* name : {"speed", "", "Position", "position "}) {
    EXPECT_FALSE(SignalFromName(name).has_value()) << name;
  }
}

TEST(Signal, ANumberThatIsNoSignalThrows) {
  const auto beyond = static_cast<Signal>(kSignalCount);
  EXPECT_THROW(SignalName(beyond), std::invalid_argument);
  EXPECT_THROW(SignalUnit(beyond, JointKind::kRevolute), std::invalid_argument);
}

TEST(Signal, ALinearJointReadsMetresForRadiansAndNewtonsForNewtonMetres) {
  for (const Signal signal : AllSignals()) {
    std::string expected(SignalUnit(signal, JointKind::kRevolute));
    EXPECT_FALSE(expected.empty()) << SignalName(signal);
    const bool motor = signal == Signal::kMotorPosition || signal == Signal::kMotorVelocity;
    if (!motor && expected.starts_with("rad")) expected.replace(0, 3, "m");
    if (expected == "Nm") expected = "N";
    EXPECT_EQ(SignalUnit(signal, JointKind::kPrismatic), expected) << SignalName(signal);
  }
  EXPECT_EQ(SignalUnit(Signal::kVelocity, JointKind::kRevolute), "rad/s");
  EXPECT_EQ(SignalUnit(Signal::kVelocity, JointKind::kPrismatic), "m/s");
  EXPECT_EQ(SignalUnit(Signal::kTorque, JointKind::kPrismatic), "N");
  EXPECT_EQ(SignalUnit(Signal::kMotorVelocity, JointKind::kPrismatic), "rad/s");
}

TEST(Signal, EverySignalHasABitOfItsOwn) {
  std::uint32_t all = 0;
  for (const Signal signal : AllSignals()) {
    EXPECT_EQ(std::popcount(SignalBit(signal)), 1) << SignalName(signal);
    EXPECT_EQ(all & SignalBit(signal), 0u) << SignalName(signal);
    all |= SignalBit(signal);
  }
  EXPECT_EQ(all, (1u << kSignalCount) - 1u);
}

// Recordings on disk carry these bits.
TEST(Signal, BitsAreThoseOfTheFileFormat) {
  EXPECT_EQ(SignalBit(Signal::kPosition), 0x1u);
  EXPECT_EQ(SignalBit(Signal::kMotorCurrent), 0x10u);
  EXPECT_EQ(SignalBit(Signal::kTemperature), 0x1000u);
  EXPECT_EQ(SignalBit(Signal::kSupplyVoltage), 0x4000u);
  EXPECT_EQ(SignalBits({}), 0u);
  EXPECT_EQ(SignalBits({Signal::kPosition, Signal::kVelocity, Signal::kPosition}), 0x3u);
  EXPECT_EQ(kMotorSignals, 0x1Cu);
  EXPECT_EQ(kOutputSignals, 0x1783u);
}

}  // namespace
}  // namespace sinew::types

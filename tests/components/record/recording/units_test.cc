#include "components/record/recording/units.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sinew::recording {
namespace {

double Si(Quantity quantity, std::string_view unit, double value) {
  const auto found = FindUnit(quantity, unit);
  EXPECT_TRUE(found.has_value()) << unit;
  return found ? found->ToSi(value) : 0.0;
}

TEST(Units, ConvertKnownValues) {
  const double tolerance = 1e-15;  // a few roundings
  EXPECT_NEAR(Si(Quantity::kAngle, "deg", 180), std::numbers::pi, tolerance);
  EXPECT_NEAR(Si(Quantity::kAngle, "rev", 0.5), std::numbers::pi, tolerance);
  EXPECT_NEAR(Si(Quantity::kAngle, "arcmin", 159.6), 2.66 * std::numbers::pi / 180, tolerance);
  EXPECT_NEAR(Si(Quantity::kAngularVelocity, "rpm", 60), 2 * std::numbers::pi, tolerance);
  EXPECT_EQ(Si(Quantity::kTime, "ms", 1), 0.001);
  EXPECT_EQ(Si(Quantity::kTime, "us", 250), 0.00025);
  EXPECT_EQ(Si(Quantity::kLength, "mm", -12.5), -0.0125);
  EXPECT_EQ(Si(Quantity::kPressure, "Pa", 250000), 2.5);
  EXPECT_EQ(Si(Quantity::kPressure, "kPa", 250), 2.5);
  EXPECT_NEAR(Si(Quantity::kPressure, "bar_abs", 1.01325), 0.0, tolerance);
  EXPECT_NEAR(Si(Quantity::kTemperature, "K", 298.15), 25.0, 1e-12);
  EXPECT_NEAR(Si(Quantity::kTemperature, "degF", 212), 100.0, 1e-12);
  EXPECT_EQ(Si(Quantity::kTorque, "Ncm", 150), 1.5);
}

TEST(Units, LeaveSiValuesBitByBit) {
  for (const double value : {0.1, -0.0, 1e-300, 7.45e-06}) {
    const double converted = Si(Quantity::kLength, "m", value);
    EXPECT_EQ(std::signbit(converted), std::signbit(value));
    EXPECT_EQ(converted, value);
  }
}

TEST(Units, AcceptTheSpellingOfKeys) {
  EXPECT_TRUE(FindUnit(Quantity::kAngularVelocity, "rad_s").has_value());
  EXPECT_TRUE(FindUnit(Quantity::kAngularVelocity, "rad/s").has_value());
}

TEST(Units, RefuseAUnitOfAnotherQuantity) {
  EXPECT_FALSE(FindUnit(Quantity::kAngle, "m").has_value());
  EXPECT_FALSE(FindUnit(Quantity::kLength, "rad").has_value());
  EXPECT_FALSE(FindUnit(Quantity::kVoltage, "v").has_value());
  EXPECT_EQ(AcceptedUnits(Quantity::kVoltage), "V, mV");
}

TEST(Units, DependOnTheKindOfJoint) {
  using types::JointKind;
  using types::Signal;
  EXPECT_EQ(QuantityOf(Signal::kPosition, JointKind::kRevolute), Quantity::kAngle);
  EXPECT_EQ(QuantityOf(Signal::kPosition, JointKind::kPrismatic), Quantity::kLength);
  EXPECT_EQ(QuantityOf(Signal::kTorque, JointKind::kPrismatic), Quantity::kForce);
  EXPECT_EQ(QuantityOf(Signal::kMotorPosition, JointKind::kPrismatic), Quantity::kAngle);
  for (const Signal signal : types::AllSignals()) {
    for (const JointKind kind : {JointKind::kRevolute, JointKind::kPrismatic}) {
      EXPECT_TRUE(FindUnit(QuantityOf(signal, kind), types::SignalUnit(signal, kind)).has_value())
          << types::SignalName(signal);
    }
  }
}

}  // namespace
}  // namespace sinew::recording

#include "components/record/recording/units.h"

#include <algorithm>
#include <span>

#include "components/base/types/angle.h"

namespace sinew::recording {
namespace {

using types::kPi;

constexpr Unit kTime[] = {{"s"}, {"ms", 1, 1e3}, {"us", 1, 1e6}, {"ns", 1, 1e9}, {"min", 60, 1}};
constexpr Unit kAngle[] = {
    {"rad"}, {"mrad", 1, 1e3}, {"deg", kPi, 180}, {"rev", 2 * kPi, 1}, {"arcmin", kPi, 180 * 60}};
constexpr Unit kLength[] = {{"m"}, {"cm", 1, 1e2}, {"mm", 1, 1e3}, {"um", 1, 1e6}};
constexpr Unit kAngularVelocity[] = {{"rad/s"},
                                     {"mrad/s", 1, 1e3},
                                     {"deg/s", kPi, 180},
                                     {"rev/s", 2 * kPi, 1},
                                     {"rpm", 2 * kPi, 60}};
constexpr Unit kVelocity[] = {{"m/s"}, {"cm/s", 1, 1e2}, {"mm/s", 1, 1e3}};
constexpr Unit kCurrent[] = {{"A"}, {"mA", 1, 1e3}};
constexpr Unit kVoltage[] = {{"V"}, {"mV", 1, 1e3}};
constexpr Unit kTorque[] = {{"Nm"}, {"mNm", 1, 1e3}, {"Ncm", 1, 1e2}, {"kNm", 1e3, 1}};
constexpr Unit kForce[] = {{"N"}, {"mN", 1, 1e3}, {"kN", 1e3, 1}};
constexpr Unit kPressure[] = {{"bar"},
                              {"mbar", 1, 1e3},
                              {"Pa", 1, 1e5},
                              {"kPa", 1, 1e2},
                              {"MPa", 10, 1},
                              {"psi", 0.0689475729, 1},
                              {"bar_abs", 1, 1, -1.01325}};
constexpr Unit kMass[] = {{"kg"}, {"g", 1, 1e3}};
constexpr Unit kTemperature[] = {{"degC"}, {"K", 1, 1, -273.15}, {"degF", 5, 9, -160.0 / 9.0}};
constexpr Unit kNumber[] = {{"1"}, {"percent", 1, 1e2}};

std::span<const Unit> Units(Quantity quantity) {
  switch (quantity) {
    case Quantity::kTime:
      return kTime;
    case Quantity::kAngle:
      return kAngle;
    case Quantity::kLength:
      return kLength;
    case Quantity::kAngularVelocity:
      return kAngularVelocity;
    case Quantity::kVelocity:
      return kVelocity;
    case Quantity::kCurrent:
      return kCurrent;
    case Quantity::kVoltage:
      return kVoltage;
    case Quantity::kTorque:
      return kTorque;
    case Quantity::kForce:
      return kForce;
    case Quantity::kPressure:
      return kPressure;
    case Quantity::kMass:
      return kMass;
    case Quantity::kTemperature:
      return kTemperature;
    case Quantity::kNumber:
      return kNumber;
  }
  return {};
}

}  // namespace

double Unit::ToSi(double value) const noexcept {
  if (numerator != 1.0) value *= numerator;
  if (denominator != 1.0) value /= denominator;
  if (offset != 0.0) value += offset;
  return value;
}

std::optional<Unit> FindUnit(Quantity quantity, std::string_view name) {
  for (const Unit& unit : Units(quantity)) {
    if (unit.name == name) return unit;
    std::string spelled(unit.name);  // "rad_s" as in keys
    std::replace(spelled.begin(), spelled.end(), '/', '_');
    if (spelled == name) return unit;
  }
  return std::nullopt;
}

std::string AcceptedUnits(Quantity quantity) {
  std::string list;
  for (const Unit& unit : Units(quantity)) {
    if (!list.empty()) list += ", ";
    list += unit.name;
  }
  return list;
}

Quantity QuantityOf(types::Signal signal, types::JointKind kind) {
  const bool linear = kind == types::JointKind::kPrismatic;
  switch (signal) {
    case types::Signal::kPosition:
    case types::Signal::kReferencePosition:
      return linear ? Quantity::kLength : Quantity::kAngle;
    case types::Signal::kVelocity:
      return linear ? Quantity::kVelocity : Quantity::kAngularVelocity;
    case types::Signal::kMotorPosition:
      return Quantity::kAngle;
    case types::Signal::kMotorVelocity:
      return Quantity::kAngularVelocity;
    case types::Signal::kMotorCurrent:
      return Quantity::kCurrent;
    case types::Signal::kDriveVoltage:
    case types::Signal::kSupplyVoltage:
      return Quantity::kVoltage;
    case types::Signal::kTorque:
      return linear ? Quantity::kForce : Quantity::kTorque;
    case types::Signal::kChamberPressure:
    case types::Signal::kReservoirPressure:
      return Quantity::kPressure;
    case types::Signal::kLoadForce:
      return Quantity::kForce;
    case types::Signal::kValveOpen:
      return Quantity::kNumber;
    case types::Signal::kPayload:
      return Quantity::kMass;
    case types::Signal::kTemperature:
      return Quantity::kTemperature;
  }
  return Quantity::kNumber;
}

}  // namespace sinew::recording

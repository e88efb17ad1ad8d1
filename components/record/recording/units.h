// Units of measured data from elsewhere, turned into the units of types::Signal.
//
// A unit is an exact ratio: value_SI = value * numerator / denominator + offset, so that "1 ms"
// becomes the double nearest to 0.001 (a division rounds once) and an SI column stays bit by bit
// what it was.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "components/base/types/joint_kind.h"
#include "components/base/types/run.h"

namespace sinew::recording {

enum class Quantity {
  kTime,             // s
  kAngle,            // rad
  kLength,           // m
  kAngularVelocity,  // rad/s
  kVelocity,         // m/s
  kCurrent,          // A
  kVoltage,          // V
  kTorque,           // Nm
  kForce,            // N
  kPressure,         // bar, gauge
  kMass,             // kg
  kTemperature,      // degC
  kNumber,           // 1
};

struct Unit {
  std::string_view name;  // as users write it: "rad/s"; "rad_s" is accepted too
  double numerator = 1.0;
  double denominator = 1.0;
  double offset = 0.0;  // added last, in the unit of the quantity

  double ToSi(double value) const noexcept;
};

// The unit of that name, or nothing when the quantity has no such unit.
std::optional<Unit> FindUnit(Quantity quantity, std::string_view name);
// "rad, deg, rev, arcmin, mrad": for messages.
std::string AcceptedUnits(Quantity quantity);
// Quantity of a signal: positions and torques of linear joints are lengths and forces.
Quantity QuantityOf(types::Signal signal, types::JointKind kind);

}  // namespace sinew::recording

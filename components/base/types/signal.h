// The measured signals of one joint: names, units and the bits that mark them as measured.
//
// The number of a signal is the number of its bit in actuator_state.measured_flags and is part of
// the file format (docs/formats.md has the table): new signals go to the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string_view>
#include <vector>

#include "components/base/types/joint_kind.h"

namespace sinew::types {

// Names as in mapping files; SI units, and bar, by kind of joint (rotary / linear).
enum class Signal {
  kPosition,           // position            rad / m      output
  kVelocity,           // velocity            rad/s / m/s  output
  kMotorPosition,      // motor_position      rad          motor shaft
  kMotorVelocity,      // motor_velocity      rad/s        motor shaft
  kMotorCurrent,       // motor_current       A
  kDriveVoltage,       // drive_voltage       V
  kTorque,             // torque              Nm / N       measured drive torque at the output
  kChamberPressure,    // chamber_pressure    bar          gauge
  kReservoirPressure,  // reservoir_pressure  bar          gauge
  kLoadForce,          // load_force          N            positive presses the link down
  kValveOpen,          // valve_open          1            0 or 1
  kPayload,            // payload             kg           declared by the operator
  kTemperature,        // temperature         degC         motor
  kReferencePosition,  // reference_position  rad / m
  kSupplyVoltage,  // supply_voltage      V            what the drive can put on the motor; 0: off
};

inline constexpr std::size_t kSignalCount = static_cast<std::size_t>(Signal::kSupplyVoltage) + 1;

// Throw std::invalid_argument for a number that is not a signal's.
std::string_view SignalName(Signal signal);
std::string_view SignalUnit(Signal signal, JointKind kind);

std::optional<Signal> SignalFromName(std::string_view name);

// In the order of their numbers.
const std::vector<Signal>& AllSignals();

constexpr std::uint32_t SignalBit(Signal signal) noexcept {
  return std::uint32_t{1} << static_cast<unsigned>(signal);
}

constexpr std::uint32_t SignalBits(std::initializer_list<Signal> signals) noexcept {
  std::uint32_t bits = 0;
  for (const Signal signal : signals) bits |= SignalBit(signal);
  return bits;
}

// Sensors that robots have together.
inline constexpr std::uint32_t kMotorSignals =
    SignalBits({Signal::kMotorPosition, Signal::kMotorVelocity, Signal::kMotorCurrent});
inline constexpr std::uint32_t kOutputSignals = SignalBits(
    {Signal::kPosition, Signal::kVelocity, Signal::kChamberPressure, Signal::kReservoirPressure,
     Signal::kLoadForce, Signal::kValveOpen, Signal::kTemperature});

}  // namespace sinew::types

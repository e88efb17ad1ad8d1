#include "components/base/types/signal.h"

#include <stdexcept>
#include <string>

namespace sinew::types {
namespace {

struct SignalRow {
  Signal signal;
  std::string_view name;
  std::string_view rotary_unit;
  std::string_view linear_unit;
};

constexpr SignalRow kRows[] = {
    {Signal::kPosition, "position", "rad", "m"},
    {Signal::kVelocity, "velocity", "rad/s", "m/s"},
    {Signal::kMotorPosition, "motor_position", "rad", "rad"},
    {Signal::kMotorVelocity, "motor_velocity", "rad/s", "rad/s"},
    {Signal::kMotorCurrent, "motor_current", "A", "A"},
    {Signal::kDriveVoltage, "drive_voltage", "V", "V"},
    {Signal::kTorque, "torque", "Nm", "N"},
    {Signal::kChamberPressure, "chamber_pressure", "bar", "bar"},
    {Signal::kReservoirPressure, "reservoir_pressure", "bar", "bar"},
    {Signal::kLoadForce, "load_force", "N", "N"},
    {Signal::kValveOpen, "valve_open", "1", "1"},
    {Signal::kPayload, "payload", "kg", "kg"},
    {Signal::kTemperature, "temperature", "degC", "degC"},
    {Signal::kReferencePosition, "reference_position", "rad", "m"},
    {Signal::kSupplyVoltage, "supply_voltage", "V", "V"},
};

const SignalRow& Row(Signal signal) {
  for (const SignalRow& row : kRows) {
    if (row.signal == signal) return row;
  }
  throw std::invalid_argument("no signal has the number " +
                              std::to_string(static_cast<int>(signal)));
}

}  // namespace

std::string_view SignalName(Signal signal) { return Row(signal).name; }

std::optional<Signal> SignalFromName(std::string_view name) {
  for (const SignalRow& row : kRows) {
    if (row.name == name) return row.signal;
  }
  return std::nullopt;
}

std::string_view SignalUnit(Signal signal, JointKind kind) {
  return kind == JointKind::kPrismatic ? Row(signal).linear_unit : Row(signal).rotary_unit;
}

const std::vector<Signal>& AllSignals() {
  static const std::vector<Signal> kAll = [] {
    std::vector<Signal> signals;
    for (const SignalRow& row : kRows) signals.push_back(row.signal);
    return signals;
  }();
  return kAll;
}

}  // namespace sinew::types

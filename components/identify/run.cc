#include "components/identify/run.h"

#include <array>
#include <stdexcept>

namespace sinew::identify {

namespace {

struct Entry {
  Signal signal;
  std::string_view name;
  std::string_view rotary_unit;
  std::string_view linear_unit;
};

constexpr std::array<Entry, 14> kSignals = {{
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
}};

const Entry& Find(Signal signal) {
  for (const Entry& entry : kSignals) {
    if (entry.signal == signal) return entry;
  }
  throw std::invalid_argument("no such signal");
}

}  // namespace

std::string_view SignalName(Signal signal) { return Find(signal).name; }

std::optional<Signal> SignalFromName(std::string_view name) {
  for (const Entry& entry : kSignals) {
    if (entry.name == name) return entry.signal;
  }
  return std::nullopt;
}

std::string_view SignalUnit(Signal signal, effects::JointKind kind) {
  const Entry& entry = Find(signal);
  return kind == effects::JointKind::kRotary ? entry.rotary_unit : entry.linear_unit;
}

const std::vector<Signal>& AllSignals() {
  static const std::vector<Signal> all = [] {
    std::vector<Signal> list;
    for (const Entry& entry : kSignals) list.push_back(entry.signal);
    return list;
  }();
  return all;
}

const Eigen::VectorXd& Run::At(Signal signal) const {
  const auto found = signals.find(signal);
  if (found == signals.end()) {
    throw std::invalid_argument("recording " + name + " has no signal '" +
                                std::string(SignalName(signal)) + "'");
  }
  return found->second;
}

}  // namespace sinew::identify

// The signals a network may have as inputs: their names in configuration and weights files, and
// their values at one tick.
//
// Computed torque: a reference_* input is the reference in the loop, and the measured motion
// (differentiated without phase shift) in training. Motor current, and anything that is a multiple
// of it, is no input: the target of the rig's networks is drive torque.
//
// reference_direction is the way of dry friction, tanh(v_ref / 0.02 rad/s): smooth neurons need
// many units to turn as sharply, and an input that the readout sees needs one weight.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "components/base/types/joints.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::esn {

// Velocity over which reference_direction turns.
inline constexpr double kDirectionWidth_rad_s = 0.02;
double ReferenceDirection(double reference_velocity_rad_s) noexcept;

enum class Signal {
  kReferencePosition,      // reference_position_rad        output, rad
  kReferenceVelocity,      // reference_velocity_rad_s
  kReferenceAcceleration,  // reference_acceleration_rad_s2
  kPosition,               // position_rad                  measured, output
  kVelocity,               // velocity_rad_s                measured, output
  kMotorVelocity,          // motor_velocity_rad_s          measured, motor shaft
  kChamberPressure,        // chamber_pressure_bar          gauge
  kPlayAngle,           // play_angle_rad                motor / N - output, from the lower contact
  kLoadForce,           // load_force_N                  positive presses the link down
  kPayload,             // declared_payload_kg
  kTemperature,         // motor_temperature_degC
  kReferenceDirection,  // reference_direction_1         -1 down, 1 up
};
inline constexpr int kSignalCount = 12;

std::string_view SignalName(Signal signal);
std::optional<Signal> SignalFromName(std::string_view name);
// The names, separated by commas, for messages.
std::string_view SignalNames();

struct Input {
  Signal signal = Signal::kReferencePosition;
  int joint = 0;

  bool operator==(const Input&) const = default;
};

// All signals of one tick. What is not known is not a number; a network that reads it then has no
// prediction.
class Frame {
 public:
  Frame() noexcept { Clear(); }
  void Clear() noexcept;  // nothing is known
  void Set(Signal signal, int joint, double value) noexcept {
    value_[static_cast<std::size_t>(signal)][static_cast<std::size_t>(joint)] = value;
  }
  double Get(Input input) const noexcept {
    return value_[static_cast<std::size_t>(input.signal)][static_cast<std::size_t>(input.joint)];
  }
  void Exchange(types::StateArchive& archive);  // types/state_archive.h

 private:
  std::array<types::JointArray<double>, kSignalCount> value_;
};

}  // namespace sinew::esn

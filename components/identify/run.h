// Measured signals of one joint in one recording: what fitting and tracing read.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "components/effects/effect.h"

namespace sinew::identify {

// Names as in mapping files; SI units by joint kind (rotary / linear).
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
  kPayload,            // payload             kg           declared
  kTemperature,        // temperature         degC         motor
  kReferencePosition,  // reference_position  rad / m
  kSupplyVoltage,  // supply_voltage      V            what the drive can put on the motor; 0: off
};

std::string_view SignalName(Signal signal);
std::optional<Signal> SignalFromName(std::string_view name);
std::string_view SignalUnit(Signal signal, effects::JointKind kind);
const std::vector<Signal>& AllSignals();

struct Run {
  std::string name;  // file it came from
  effects::JointKind kind = effects::JointKind::kRotary;
  Eigen::VectorXd time_s;                     // strictly increasing, not necessarily uniform
  std::map<Signal, Eigen::VectorXd> signals;  // each as long as time_s
  std::string content_hash;                   // of the samples, for the history of a model
  // Every row is a hold of its own: the joint stood there, nothing happens between two rows.
  bool held = false;
  // Rows of the file that were interpolated and left out (interpolated.h).
  Eigen::Index interpolated_rows = 0;
  // Angles whose encoder begins each recording at a zero of its own: such an angle is the reading
  // plus a constant that nobody knows and that is another one in the next recording. Its changes
  // and derivatives are what they are; the phase of gravity, rest angles, the offset between two
  // encoders and any curve over the angle belong to this recording alone.
  std::set<Signal> zero_unknown;
  // What the rigid bodies of the arm need of this joint (arm::Arm), per piece of MakeStates and
  // sample; empty for a joint that is no part of an arm.
  std::vector<Eigen::VectorXd> rigid_torque;
  // How that changes with the bodies, samples x directions; may be empty. What the other joints of
  // the arm say of each direction: its change is normal with this mean and standard deviation; 0:
  // nothing.
  std::vector<Eigen::MatrixXd> rigid_columns;
  Eigen::VectorXd rigid_mean, rigid_spread;
  double rigid_inertia = 0.0;       // of the bodies about the joint, rms over the motion
  bool rigid_torque_later = false;  // it is being computed: not missing

  Eigen::Index size() const { return time_s.size(); }
  bool Has(Signal signal) const { return signals.count(signal) != 0; }
  const Eigen::VectorXd& At(
      Signal signal) const;  // throws std::invalid_argument naming signal and run
};

}  // namespace sinew::identify

// Feed-forward: the motor torque that the reference motion needs, from the model file.
//
// kLinear, the published compensator (7.1), at the motor shaft:
//
//     tau_c = J_total dw/dt + B_total w + K_total theta - Kp P / N + T_load / N
//
// with theta, w of the motor from the reference (N times the output), J_total N^2 = rotor, link and
// declared payload inertia, B_total N^2 = viscous friction, K_total N^2 = k1 P (about the rest
// angle), Kp = K, T_load = F l. Gravity and dry friction are not in (7.1) and stay with the PID.
// Divided by the drive's efficiency, because Ke in (4.12) is torque that reaches the gear.
//
// kModel: JointModel::RequiredDriveInput at the reference state, with every term of the model file,
// so that an effect which close-loop added is compensated too. Terms that jump with the sign of
// velocity are smoothed: below smoothing_rad_s the torque is the straight line between those at -v
// and +v.
//
// kRecorded: a torque over time, found beforehand for this very reference (tools/control_test makes
// one by iterative inversion of the surrogate); straight lines between its points, held at its
// ends. Time counts from the first step with a reference. It knows nothing of the joint: a bound
// for comparisons, not a way to run one.
//
// Angle-dependent motor terms (cogging) read the measured motor angle: the free play hides it from
// the reference. Thread: one. Step is noexcept and allocates nothing.
#pragma once

#include <vector>

#include "components/model/actuator/model.h"
#include "components/robot/control/types.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::control {

enum class CompensatorKind { kNone, kLinear, kModel, kRecorded };

struct RecordedTorque {
  double period_s = 0.0;
  std::vector<double> motor_torque_Nm;  // at the shaft, from the start of the reference
};

struct CompensatorConfig {
  CompensatorKind kind = CompensatorKind::kNone;
  double smoothing_rad_s = 0.05;
  double pressure_filter_Hz = 5.0;  // measured pressure and load force are smoothed; 0: as they are
  double lead_s = 0.0;              // the reference this much later: delay of the drive
  RecordedTorque recorded = {};     // kRecorded only
};

// Motor torque per output torque: 1 / (N * efficiency); for a prismatic axis force per force.
double ShaftPerOutput(const actuator::JointModel& model);
// Motor torque (force command of a prismatic axis) per unit of the drive input: Kt, or the force
// constant.
double ShaftPerDriveInput(const actuator::JointModel& model);

class Compensator {
 public:
  // Throws std::invalid_argument for a model without a drive, negative figures, or a recorded
  // torque that is empty, not finite or without a period.
  Compensator(const actuator::JointModel& model, const CompensatorConfig& config);

  void Reset() noexcept;
  // Motor torque at the shaft. Reads the actuator values of m even when they are old: the caller
  // decides.
  double Step(const Point& reference, const MeasuredJointState& m, double period_s) noexcept;
  // Exchanges the state that Step needs beside its input, to the bit: types/state_archive.h.
  // Reading, throws std::invalid_argument.
  void Exchange(types::StateArchive& archive);

 private:
  double Recorded() const noexcept;
  double Linear(const Point& reference, const MeasuredJointState& m) const noexcept;
  double Model(const Point& reference, const MeasuredJointState& m, double period_s) noexcept;
  effects::JointSample Sample(const Point& reference, const MeasuredJointState& m) const noexcept;

  actuator::JointModel model_;
  CompensatorConfig config_;
  double shaft_per_output_;
  double shaft_per_input_;
  // (7.1), at the output
  double inertia_kg_m2_ = 0.0;
  double viscous_Nm_s_rad_ = 0.0;
  double stiffness_Nm_rad_bar_ = 0.0;
  double rest_angle_rad_ = 0.0;
  double pneumatic_Nm_bar_ = 0.0;
  double load_share_ = 0.0;
  double payload_share_ = 0.0;

  std::vector<double> memory_;
  double time_s_ = 0.0;
  bool started_ = false;
  double pressure_bar_ = 0.0;
  double pressure_rate_bar_s_ = 0.0;
  double load_force_N_ = 0.0;
};

}  // namespace sinew::control

// Inputs and outputs of control in one tick, without messages. Units and signs as in idl/: output
// angle positive up; a prismatic joint reads m for rad and N for Nm (docs/decisions/0003).
#pragma once

#include <cstdint>
#include <limits>

#include "components/base/types/control_mode.h"
#include "components/base/types/joints.h"
#include "components/base/types/motion.h"
#include "components/base/types/regime.h"
#include "components/robot/reference/trajectory.h"

namespace sinew::types {
class StateArchive;
}

namespace sinew::control {

using reference::Point;

// Sensor values of one joint, from joint_state and actuator_state.
struct MeasuredJointState {
  bool valid = false;                 // position and velocity
  double position_rad = 0.0;          // output
  double velocity_rad_s = 0.0;        // output
  bool actuator_valid = false;        // the rest
  double motor_position_rad = 0.0;    // motor shaft
  double motor_velocity_rad_s = 0.0;  // motor shaft
  double pressure_bar = 0.0;
  double load_force_N = 0.0;
  double payload_kg = 0.0;
  double temperature_degC = 25.0;
  bool valve_open = false;

  void Exchange(types::StateArchive& archive);  // types/state_archive.h
};

// Drive torques at the output that the networks ask for.
struct JointPrediction {
  bool valid = false;
  double sea_torque_Nm = 0.0;
  double pea_torque_Nm = 0.0;
  double torque_Nm = 0.0;  // of the network that the predictor chose

  void Exchange(types::StateArchive& archive);  // types/state_archive.h
};

struct MotionOrder {
  types::Motion kind = types::Motion::kNone;
  double target_rad = 0.0;
  double velocity_limit_rad_s = 0.0;
  double motor_torque_limit_Nm = 0.0;  // 0: the joint's own

  void Exchange(types::StateArchive& archive);  // types/state_archive.h
};

// Lateness of an input of which there is nothing.
inline constexpr double kNoInput = std::numeric_limits<double>::infinity();

// The cycle's inputs that count for every joint.
struct CycleInput {
  double period_s = 0.0;
  bool interrupted = false;  // armed, but the last command did not count or may not have: the
                             // provider bridges a gap
  bool stands_by = false;    // the robot gets another controller's commands, or may get them: what
                             // this one holds is where the joint is

  bool reference_fresh = false;        // belongs to this tick and is not marked stale
  double reference_late_s = kNoInput;  // else: how old it is
  bool reference_changed = false;      // it comes from another generator than the one before: the
                                       // step to it fades out
  bool reference_replayed = false;     // a recording's, on live hardware
  bool prediction_fresh = false;
  double prediction_late_s = kNoInput;
  bool prediction_changed = false;  // it comes from another predictor: likewise
  bool regime_fresh = false;
  double regime_late_s = kNoInput;
};

struct RobotInput : CycleInput {
  std::uint64_t session_id = 0;
  bool armed = false;  // the provider lets commands through
  int joint_count = 0;
  types::JointArray<MeasuredJointState> joint{};
  int reference_count = 0;  // 0: nothing is asked for
  types::JointArray<Point> reference{};
  types::JointArray<JointPrediction> prediction{};
  types::JointArray<types::Regime> regime{};
  types::JointArray<MotionOrder> motion{};
};

// Why a command is the safe one. Fault codes up to kLastLatched stay until the robot is disarmed.
enum class Fault {
  kNone,
  kNonFiniteState,      // latched: a position or velocity is not a number
  kNonFiniteReference,  // latched
  kNonFiniteOutput,     // latched: gains or model gave no number
  kTrackingError,       // latched: further from the reference than allowed
  kLastLatched = kTrackingError,
  kNonFinitePrediction,  // the network is left out
  kOtherRobot,           // joint_state has another number of joints than the configuration
};
const char* FaultText(Fault fault) noexcept;

struct JointOutput {
  types::ControlMode mode = types::ControlMode::kIdle;
  double motor_torque_Nm = 0.0;  // at the motor shaft
  double position_rad = 0.0;     // what the joint should be at; output side
  double velocity_rad_s = 0.0;
  bool saturated = false;        // the torque limit cut the command
  double compensation_Nm = 0.0;  // the feed-forward part of motor_torque_Nm
};

struct RobotOutput {
  bool stale = false;
  Fault fault = Fault::kNone;
  int fault_joint = -1;
  int joint_count = 0;
  types::JointArray<JointOutput> joint{};
};

}  // namespace sinew::control

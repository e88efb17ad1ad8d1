// Rig, pressure, reference and control in one process and one thread: the same libraries as the
// participants, without DDS. For tuning and for trying controllers, thousands of seconds a minute.
//
// Tick k: sensors of tick k -> reference, pneumatics, regime, control -> command applied from k to
// k + 1, as in lockstep.
#pragma once

#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "components/robot/control/robot_controller.h"
#include "components/robot/pneumatics/manager.h"
#include "components/robot/provider/plant.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/robot/reference/robot_reference.h"

namespace sinew::tune {

struct ClosedLoopConfig {
  std::vector<control::JointControlConfig> control;
  reference::RobotReferenceConfig reference;
  std::vector<pneumatics::ManagerConfig> pneumatics;  // empty: relays stay off
  double rate_Hz = 240.0;
  int delay_ticks = 0;        // a command acts this much later: slow buses
  double duration_s = 0.0;    // from arming
  double score_from_s = 0.0;  // earlier samples do not count
  double score_to_s = 1e9;
  std::vector<int> scored_joints = {0};  // the source scores the six joints that squat
  // Sees what the sensors say at every tick, before the command; may be empty.
  std::function<void(double time_s, const provider::PlantSensors&)> each_tick = {};
  // Asked at the end of every tick: true ends the run, the robot fell (HasFallen). May be empty.
  std::function<bool()> fallen = {};
};

// The first scored joint in one tick.
struct ClosedLoopTick {
  double time_s = 0.0;  // from arming
  bool idle = true;     // no reference
  double reference_rad = 0.0;
  double position_rad = 0.0;     // measured
  double motor_torque_Nm = 0.0;  // commanded, at the shaft
  double compensation_Nm = 0.0;  // its feed-forward part
};

// Score of the scored joints, means over joints and ticks.
struct ClosedLoopScore {
  double mse_rad2 = 0.0;  // reference against measured output
  double worst_rad = 0.0;
  double torque_rms_Nm = 0.0;         // at the motor shaft
  double torque_change_rms_Nm = 0.0;  // from tick to tick: chatter
  double saturated_share = 0.0;
  bool faulted = false;
  std::optional<double> fell_at_s;  // from arming; what is above is of the ticks before
};

struct FallLimits {
  double least_height_m = 0.0;              // of the base's origin above z = 0
  double most_tilt_rad = std::numbers::pi;  // of the base's z axis from the world's
};

// The base of a simulated robot is below its least height (Z_base link < Z_min, Algorithm 2, line
// 6), or tilted by more than the most. False for a robot on a fixed base.
bool HasFallen(const provider::SimulatedPlant& plant, const FallLimits& limits) noexcept;

// Measured state of a joint for a controller, as the topics would carry it.
control::MeasuredJointState MeasuredJoint(const provider::PlantSensors& sensors,
                                          std::size_t joint) noexcept;

// trace: a row a tick; may be null. Throws std::invalid_argument: no scored joint, or one that the
// plant lacks.
ClosedLoopScore RunClosedLoop(const ClosedLoopConfig& config, provider::Plant& plant,
                              std::vector<ClosedLoopTick>* trace = nullptr);

}  // namespace sinew::tune

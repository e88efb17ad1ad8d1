// One run of the simulated biped as sinew-world and its chain make it in lockstep, in one thread
// and without DDS: reference, inverse dynamics, control, the state provider's cycle with its guard,
// and the robot on the ground.
//
// Tick k: sensors of tick k -> reference, prediction, control -> guard -> disturbance of tick k ->
// the plant's step -> guard's look at joints and falls, truth. Times are of the end of a tick, from
// the start of the session, in which the robot is armed from the first tick on.
//
// A fall, by the truth (sim_body_truth's values, no sensor):
//
//     the base's z axis is tilted by more than 30 degrees, or
//     the base is lower than 0.8 of the height that the reference asks for, above the ground.
//
// SI units. Thread: one; runs share nothing.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "components/base/types/angle.h"
#include "components/learn/esn/inverse_dynamics.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/provider/guard.h"
#include "components/robot/reference/robot_reference.h"
#include "sim/body_disturbance/schedule.h"
#include "sim/world/file/world_file.h"

namespace sinew::falls {

inline constexpr double kRate_Hz = 240.0;
inline constexpr double kFallenTilt_rad = 30.0 * types::kDegree_rad;
inline constexpr double kFallenShare = 0.8;
// The base of robots/biped that lies on its side: half the distance of the hips, 0.075 m, and an
// actuator's radius, 0.035 m. Below it the simulation, in which the feet alone touch the ground, is
// no robot any more.
inline constexpr double kLying_m = 0.11;

// Files of a robot on two legs, its deployments' own.
struct RunFiles {
  std::filesystem::path world;
  std::filesystem::path reference;
  std::filesystem::path control;
  std::filesystem::path inverse_dynamics;  // read when a joint of control uses a prediction
};

struct RunConfig {
  world::WorldFile world;
  provider::GuardConfig guard;
  reference::RobotReferenceConfig reference;
  control::ControlConfig control;
  std::optional<esn::InverseDynamicsConfig> inverse_dynamics;
  body_disturbance::Schedule schedule{{}, {}};  // times from the first tick on
  double duration_s = 0.0;
  // The run ends so long after the guard has found a fall, or the truth, where nobody guards.
  double after_s = 0.0;
};

// Throws UsageError: what the files' readers refuse, a world without a guard against falls.
RunConfig LoadRun(const RunFiles& files);
// The same robot with nobody who looks for falls.
RunConfig Unguarded(RunConfig config);

struct RunResult {
  double upright_s = -1.0;       // the detector had started; -1: never
  std::optional<double> fell_s;  // by the truth
  std::optional<double> fault_s;
  std::string message;  // of the fault: the criterion with its figures
  // From the tick after the fault on every joint was commanded what on_fall declares: idle, or the
  // torque of the damping and nothing else. False without a fault.
  bool safe = false;
  double largest_tilt_rad = 0.0, least_share = 1.0;  // truth, until the fault
  double largest_descent_m_s = 0.0;  // of the base, in the whole run, above kLying_m
};

// Throws std::invalid_argument or UsageError for what cannot be simulated, std::runtime_error when
// the simulation diverges.
RunResult Run(const RunConfig& config);

}  // namespace sinew::falls

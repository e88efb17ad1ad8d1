// The residual monitor on the surrogate under control: changes are reported in time, and nothing is
// reported without one.
//
// Rig, pressure, reference and control in one thread (tools/tune_pid/closed_loop.h); the monitor
// sees what the participant would. The specimen is off the model it watches with by up to `spread`,
// which the monitor has to learn. A change comes at a random time after the learning: a mass put on
// the load cell, the output's dry friction or the motor's viscous friction grown by a share.
// Deterministic for a seed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/robot/control/joint_controller.h"
#include "components/robot/pneumatics/manager.h"
#include "components/robot/residual/monitor.h"

namespace sinew::acceptance {

// Required: a change is reported after this time at most.
inline constexpr double kInTime_s = 5.0;

// What the loop is made of.
struct ResidualBench {
  actuator::JointModel model;  // watched with
  control::JointControlConfig control;
  pneumatics::ManagerConfig pneumatics;
  residual::MonitorConfig monitor;
};
// Of robots/rig: surrogate_model.yaml, control_pid_model.yaml, pneumatics.yaml. Throws UsageError.
ResidualBench LoadResidualBench(const std::filesystem::path& rig_folder);

enum class ResidualMotion { kSine, kSlowSine, kMultisine, kRamps, kTask };
const std::vector<ResidualMotion>& ResidualMotions();
std::string MotionName(ResidualMotion motion);

struct ResidualCase {
  ResidualMotion motion = ResidualMotion::kSine;
  double pressure_bar = 4.0;
  double spread = 0.1;
  double payload_kg = 0.0;  // put on
  double dry_share = 1.0;   // of what they were
  double viscous_share = 1.0;
  double change_at_s = 0.0;  // 0: never
  double seconds = 80.0;
  std::uint64_t seed = 1;
};

struct ResidualScore {
  ResidualCase at;
  double watched_s = 0.0;  // after learning, in motion or not, before the change
  double excited_s = 0.0;  // of these, not reported as "not excited"
  int false_alarms = 0;
  double first_false_s = 0.0;
  bool reported = false;
  double delay_s = 0.0;        // from the change to the alarm
  double since_error_s = 0.0;  // reported time of the change less the true one
  residual::Cause follows = residual::Cause::kNothing;  // 5 s after the change
  residual::Cause rival = residual::Cause::kNothing;
  double change = 0.0;
  double change_error = 0.0;
  double noise_Nm = 0.0, correlation = 0.0, highest = 0.0;  // of the statistic before the change
};
ResidualScore RunResidualCase(const ResidualBench& bench, const ResidualCase& at);

// The grid: changes (each kind, each motion that shows it) and hours without.
std::vector<ResidualCase> ResidualChanges(bool quick);
std::vector<ResidualCase> ResidualHours(bool quick);
// "payload 0.5 kg", "dry friction x 1.3", ...
std::string ChangeName(const ResidualCase& at);
// The cause that it is.
residual::Cause TrueCause(const ResidualCase& at);

// True when the change was reported within kInTime_s and nothing before it.
bool InTime(const ResidualScore& score);
// True when the cause reported 5 s after the change, or its rival, is the true one.
bool CauseIsRight(const ResidualScore& score);

}  // namespace sinew::acceptance

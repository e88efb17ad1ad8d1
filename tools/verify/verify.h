// The correction used: a model file before and after, unchanged, where simulation and control read
// them.
//
// Beside a recording: the rig of sim/world (Bullet, the model's URDF) is moved by the recorded
// drive from the recorded state for a horizon, again and again; in closed loop where the model
// declares its servo and the recording holds the set point (components/model/free_run). Pressure,
// load force, payload and temperature are the recorded ones. Error: simulated less measured
// position.
//
// In control: the surrogate, with an undeclared effect, follows a reference under PID
// with the model's torque fed forward (tools/tune_pid/closed_loop.h): once with each model file.
#pragma once

#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/free_run/free_run.h"
#include "components/model/report/section.h"
#include "sim/surrogate/parameters.h"
#include "tools/tune_pid/closed_loop.h"

namespace sinew::verify {

// The joint of a robot of one joint as free_run moves it: in the world. Throws UsageError: a URDF
// that cannot be read; std::invalid_argument: more than one joint, a model that is not the URDF's.
// Without a URDF the body is a point that has what the model says.
free_run::MakeBody InWorld(const actuator::RobotModel& robot);

// before, after: robots of one joint of the same name. processing must be resolved.
free_run::FreeRunResult FollowRecordings(const std::vector<types::Run>& runs,
                                         const actuator::RobotModel& before,
                                         const actuator::RobotModel& after,
                                         const identify::ProcessingOptions& processing,
                                         double horizon_s);

// A model without the terms that close-loop added.
actuator::RobotModel WithoutAdded(actuator::RobotModel robot);

struct TrackingRun {
  std::uint64_t seed = 1;
  tune::ClosedLoopScore before, after;
};
struct TrackingSetup {
  tune::ClosedLoopConfig before, after;  // the same but for the model in the controller
  surrogate::RigParameters rig;          // with its effects; the seed is set for every run
};
TrackingRun Track(const TrackingSetup& setup, std::uint64_t seed);

// Names of what was done and found, for people.
struct Names {
  std::string before, after;  // model files
  std::vector<std::string> added;
  std::string effects;  // of the surrogate, "none" or as given
};
report::Section MakeSection(const Names& names, types::JointKind kind,
                            const free_run::FreeRunResult* following,
                            const std::vector<TrackingRun>& tracking);
// verify.json.
std::string FormatJson(const Names& names, types::JointKind kind,
                       const free_run::FreeRunResult* following,
                       const std::vector<TrackingRun>& tracking);

}  // namespace sinew::verify

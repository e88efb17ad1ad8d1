// Reads `schema: sinew-control/1` (docs/participants/control.md). Throws UsageError.
#pragma once

#include <filesystem>
#include <vector>

#include "components/base/config/fields.h"
#include "components/robot/control/joint_controller.h"

namespace sinew::control {

inline constexpr char kSchema[] = "sinew-control/1";

// Defaults of tracking_error_limit: a joint further from its reference does not follow it. Twice
// the largest error of the shipped references on the rig with PID alone and 0.5 kg undeclared,
// 0.287 rad (tests/tools/tune_pid/closed_loop_test.cc, which fails when a reference comes nearer).
// Of the one axis that moves in metres the largest error is 2 mm (tests/components/robot/control/
// participants_test.cc); ten times that, as it is one axis only.
inline constexpr double kTrackingErrorLimit_rad = 0.6;
inline constexpr double kTrackingErrorLimit_m = 0.02;

// Ways of motion requests to the controller.
enum class MotionRequests {
  kOff,        // not read
  kOptional,   // read when they come; they end when not repeated (real time only)
  kEveryTick,  // the requester publishes in every tick: awaited in lockstep, one tick late
};

struct ControlConfig {
  std::vector<JointControlConfig> joints;
  // The robot's, compared before anybody arms; as joints, or empty: not compared.
  std::vector<std::string> joint_names;
  MotionRequests motion_requests = MotionRequests::kOff;
  double motion_timeout_s = 0.5;

  bool needs_prediction() const;  // a joint uses pid_esn or computed_torque
  bool needs_regime() const;      // and chooses by regime
};

void Describe(config::Fields& fields, ControlConfig& config,
              const std::filesystem::path& model_path = {});
// model_path: takes the place of every joint's `model`; empty: as the file says.
ControlConfig LoadControl(const std::filesystem::path& path,
                          const std::filesystem::path& model_path = {});

}  // namespace sinew::control

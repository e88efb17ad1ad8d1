#include "components/robot/residual/file/residual_file.h"

#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::residual {

using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, MonitorConfig& m) {
  f("window_s", m.window_s, {1e-3, 1.0},
    "polynomial of degree 4 that gives velocity and acceleration; half of it is delay");
  f("block_s", m.block_s, {1e-2, 10.0}, "the test uses means over blocks");
  f("learn_s", m.learn_s, kPositive, "of motion, at least 60 blocks");
  f("watch_s", m.watch_s, kPositive, "the test uses at most this much motion");
  f("false_alarm_h", m.false_alarm_h, {0.01, 1e9},
    "mean hours of motion without a change until an alarm");
  f("slack_share", m.slack_share, {0.0, 1.0},
    "smaller changes are not reported: share of the drive torque's rms");
  f("slack_Nm", m.slack_Nm, kNotNegative, "nor those below this torque");
  f("drift_1_h", m.drift_1_h, {0.0, 1.0},
    "parameters may wander by this share of their tolerance in an hour");
  f("rest_velocity_rad_s", m.rest_velocity_rad_s, kPositive, "left out: slower");
  f("reversal_guard_s", m.reversal_guard_s, {0.0, 1.0}, "left out: beside reversals");
  f("settle_distance_rad", m.settle_distance_rad, kNotNegative, "left out: after them");
  f("not_excited_after_s", m.not_excited_after_s, kPositive, "without a usable block");
}

void Describe(config::Fields& f, ResidualConfig& c, const std::filesystem::path& model_path) {
  std::filesystem::path model;
  f.PathOr("model", model, model_path, "what the robot is compared with; all its joints", true);
  Describe(f, c.monitor);
  f.Check("model", [&] {
    constexpr double kAnyPeriod_s = 1e-3;  // figures that do not go together show at any
    c.robot = actuator::LoadRobotModel(model);
    if (c.robot.joints.empty() || c.robot.joints.size() > types::kMaxJoints) {
      throw std::invalid_argument("has " + std::to_string(c.robot.joints.size()) +
                                  " joints, expected 1 to " + std::to_string(types::kMaxJoints));
    }
    for (const auto& joint : c.robot.joints) Monitor(joint, c.monitor, kAnyPeriod_s);
  });
}

ResidualConfig LoadResidual(const std::filesystem::path& path,
                            const std::filesystem::path& model_path) {
  return config::Read<ResidualConfig>(config::Section::Load(path, kSchema), model_path);
}

}  // namespace sinew::residual

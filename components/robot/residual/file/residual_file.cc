#include "components/robot/residual/file/residual_file.h"

#include <stdexcept>
#include <string>

#include "components/base/types/joints.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::residual {
namespace {

using config::kNotNegative;
using config::kPositive;
constexpr double kAnyPeriod_s = 1e-3;  // figures that do not go together show at any

}  // namespace

ResidualConfig ReadResidual(const config::Section& s, const std::filesystem::path& model_path) {
  ResidualConfig config;
  MonitorConfig& m = config.monitor;
  // Also when it is replaced: a file is checked whole.
  const std::filesystem::path own =
      model_path.empty() ? s.ExistingPath("model") : std::filesystem::path(s.Text("model"));
  config.robot = actuator::LoadRobotModel(model_path.empty() ? own : model_path);
  m.window_s = s.NumberOr("window_s", m.window_s, {1e-3, 1.0});
  m.block_s = s.NumberOr("block_s", m.block_s, {1e-2, 10.0});
  m.learn_s = s.NumberOr("learn_s", m.learn_s, kPositive);
  m.watch_s = s.NumberOr("watch_s", m.watch_s, kPositive);
  m.false_alarm_h = s.NumberOr("false_alarm_h", m.false_alarm_h, {0.01, 1e9});
  m.slack_share = s.NumberOr("slack_share", m.slack_share, {0.0, 1.0});
  m.slack_Nm = s.NumberOr("slack_Nm", m.slack_Nm, kNotNegative);
  m.drift_1_h = s.NumberOr("drift_1_h", m.drift_1_h, {0.0, 1.0});
  m.rest_velocity_rad_s = s.NumberOr("rest_velocity_rad_s", m.rest_velocity_rad_s, kPositive);
  m.reversal_guard_s = s.NumberOr("reversal_guard_s", m.reversal_guard_s, {0.0, 1.0});
  m.settle_distance_rad = s.NumberOr("settle_distance_rad", m.settle_distance_rad, kNotNegative);
  m.not_excited_after_s = s.NumberOr("not_excited_after_s", m.not_excited_after_s, kPositive);
  s.RejectUnknownKeys();
  if (config.robot.joints.empty() || config.robot.joints.size() > types::kMaxJoints) {
    s.Fail("model", "has " + std::to_string(config.robot.joints.size()) +
                        " joints, expected 1 to " + std::to_string(types::kMaxJoints));
  }
  for (const actuator::JointModel& joint : config.robot.joints) {
    try {
      static_cast<void>(Monitor(joint, m, kAnyPeriod_s));
    } catch (const std::invalid_argument& error) {
      s.Fail("model", error.what());
    }
  }
  return config;
}

ResidualConfig LoadResidual(const std::filesystem::path& path,
                            const std::filesystem::path& model_path) {
  return ReadResidual(config::Section::Load(path, "sinew-residual/1"), model_path);
}

}  // namespace sinew::residual

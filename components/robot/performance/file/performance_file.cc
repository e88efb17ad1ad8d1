#include "components/robot/performance/file/performance_file.h"

#include <stdexcept>

#include "components/base/types/joints.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::performance {
namespace {

using config::kNotNegative;
using config::kPositive;
constexpr double kUsualPeriod_s = 1.0 / 240.0;  // figures that do not go together show at any

}  // namespace

PerformanceConfig ReadPerformance(const config::Section& s) {
  PerformanceConfig config;
  const actuator::RobotModel model = actuator::LoadRobotModel(s.ExistingPath("model"));
  if (model.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    s.Fail("model", "has " + std::to_string(model.joints.size()) + " joints, expected at most " +
                        std::to_string(types::kMaxJoints));
  }
  JointPerformanceConfig common;
  common.window_s = s.NumberOr("window_s", common.window_s, kPositive);
  common.bridge_s = s.NumberOr("bridge_s", common.bridge_s, kNotNegative);
  const std::vector<double> resistance_Ohm = s.NumbersOr("copper_resistance_Ohm", {}, kPositive);
  if (!resistance_Ohm.empty() && resistance_Ohm.size() != model.joints.size()) {
    s.Fail("copper_resistance_Ohm", "has " + std::to_string(resistance_Ohm.size()) +
                                        " entries, expected one for each of " +
                                        std::to_string(model.joints.size()) + " joints");
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const actuator::JointModel& joint = model.joints[j];
    config.joint_names.push_back(joint.name);
    config.linear.push_back(joint.kind == types::JointKind::kLinear);
    JointPerformanceConfig& one = config.robot.joints.emplace_back(common);
    one.motor.torque_constant_Nm_A = joint.constants.torque_constant_Nm_A;
    one.motor.gear_ratio = joint.constants.gear_ratio;
    if (!resistance_Ohm.empty()) one.motor.copper_resistance_Ohm = resistance_Ohm[j];
  }
  if (s.Has("lifting")) {
    const config::Section lifting = s.Child("lifting");
    const std::filesystem::path urdf = lifting.ExistingPath("urdf");
    const std::vector<std::string> on_ground = lifting.TextsOr("on_ground", {});
    config.robot.lift_band_m = lifting.NumberOr("band_m", config.robot.lift_band_m, kPositive);
    lifting.RejectUnknownKeys();
    try {
      config.height.emplace(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()),
                            config.joint_names, on_ground);
    } catch (const std::invalid_argument& error) {
      lifting.Fail("urdf", error.what());
    }
    config.robot.mass_kg = config.height->mass_kg();
  }
  s.RejectUnknownKeys();
  try {
    static_cast<void>(RobotPerformance(config.robot, kUsualPeriod_s));
  } catch (const std::invalid_argument& error) {
    s.Fail("model", error.what());
  }
  return config;
}

PerformanceConfig LoadPerformance(const std::filesystem::path& path) {
  return ReadPerformance(config::Section::Load(path, "sinew-performance/1"));
}

}  // namespace sinew::performance

#include "components/robot/performance/file/performance_file.h"

#include <stdexcept>

#include "components/base/types/joints.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::performance {

using config::kNotNegative;
using config::kPositive;

// Sets names and motors. Throws std::invalid_argument.
static void FillJoints(const actuator::RobotModel& model, const JointPerformanceConfig& common,
                       const std::vector<double>& resistance_Ohm, PerformanceConfig* c) {
  if (model.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    throw std::invalid_argument("has " + std::to_string(model.joints.size()) +
                                " joints, expected at most " + std::to_string(types::kMaxJoints));
  }
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    const actuator::JointModel& joint = model.joints[j];
    c->joint_names.push_back(joint.name);
    c->linear.push_back(joint.kind == types::JointKind::kPrismatic);
    JointPerformanceConfig& one = c->robot.joints.emplace_back(common);
    one.motor.torque_constant_Nm_A = joint.constants.torque_constant_Nm_A;
    one.motor.gear_ratio = joint.constants.gear_ratio;
    if (!resistance_Ohm.empty()) one.motor.copper_resistance_Ohm = resistance_Ohm.at(j);
  }
}

void Describe(config::Fields& f, PerformanceConfig& c) {
  std::filesystem::path model_path;
  JointPerformanceConfig common;
  std::vector<double> resistance_Ohm;
  f.Need("model", model_path,
         "joints in the order of joint_state; gear ratio and torque constant count");
  f("window_s", common.window_s, kPositive, "of the sliding rms");
  f("bridge_s", common.bridge_s, kNotNegative, "gaps up to this are bridged");
  f("copper_resistance_Ohm", resistance_Ohm, kPositive,
    "one for each joint; R I^2 is the loss at the current for which Kt I is the motor's torque; "
    "left out: no electrical energy");
  const actuator::RobotModel model =
      f.reads() ? actuator::LoadRobotModel(model_path) : actuator::RobotModel{};
  if (!resistance_Ohm.empty() && resistance_Ohm.size() != model.joints.size()) {
    f.Fail("copper_resistance_Ohm", "has " + std::to_string(resistance_Ohm.size()) +
                                        " entries, expected one for each of " +
                                        std::to_string(model.joints.size()) + " joints");
  }
  f.If("lifting", "the bound on lifting work; left out: none", [&](config::Fields& lifting) {
    std::filesystem::path urdf;
    std::vector<std::string> on_ground;
    lifting.Need("urdf", urdf, "bodies and masses");
    lifting("on_ground", on_ground, "links that stand");
    lifting("band_m", c.robot.lift_band_m, kPositive, "smaller turns of the height are noise");
    lifting.Check("urdf", [&] {
      std::vector<std::string> names;
      names.reserve(model.joints.size());
      for (const actuator::JointModel& joint : model.joints) names.push_back(joint.name);
      c.height.emplace(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()), names, on_ground);
      c.robot.mass_kg = c.height->mass_kg();
    });
  });
  f.Check("model", [&] {
    constexpr double kUsualPeriod_s = 1.0 / 240.0;  // figures that do not go together show at any
    FillJoints(model, common, resistance_Ohm, &c);
    static_cast<void>(RobotPerformance(c.robot, kUsualPeriod_s));
  });
}

PerformanceConfig LoadPerformance(const std::filesystem::path& path) {
  return config::Read<PerformanceConfig>(config::Section::Load(path, kSchema));
}

}  // namespace sinew::performance

#include "components/learn/rls/file/rls_config.h"

#include <string>

#include "components/model/actuator/file/model_file.h"

namespace sinew::rls {
using config::kNotNegative;
using config::kPositive;

static void CheckOutputs(const config::Fields& f, const char* key,
                         const std::optional<esn::Weights>& weights,
                         const actuator::RobotModel& robot) {
  if (!weights) return;
  if (weights->target != "drive_torque_Nm") {
    f.Fail(key, "target '" + weights->target + "', expected 'drive_torque_Nm'");
  }
  if (static_cast<std::size_t>(weights->output_count()) > robot.joints.size()) {
    f.Fail(key, std::to_string(weights->output_count()) +
                    " outputs, expected at most one for each of the " +
                    std::to_string(robot.joints.size()) + " joints of the model");
  }
}

static void Describe(config::Fields& f, TargetConfig& c, const actuator::RobotModel& robot) {
  f("carry_over", c.carry_over, "target equation of docs/participants/rls.md; or the drive torque");
  f("half_window_ticks", c.half_window_ticks, {1, 100},
    "of the parabola that gives velocity and acceleration");
  f.Word("motion_from", c.motion_from_motor, {{"motor", true}, {"output", false}},
         "whose angle that is");
  f("smoothing_rad_s", c.smoothing_rad_s, kPositive, "dry friction of the model turns over it");
  c.stance = esn::DescribeStance(f, robot);
}

static void Describe(config::Fields& f, AdapterConfig& c) {
  Config& rls = c.rls;
  f("forgetting", rls.forgetting, {1e-6, 1.0}, "lambda, per tick");
  f("directional", rls.directional, "forgets in the direction of a sample only");
  f("prior_precision", rls.prior_precision, kPositive,
    "delta: how much the offline readout counts");
  f("leak", rls.leak, kNotNegative, "share of what is forgotten that returns to it");
  f("clip_sigmas", rls.clip_sigmas, kNotNegative, "larger innovations count less; 0: none does");
  f("innovation_memory", rls.innovation_memory, {1e-12, 1.0 - 1e-12}, "of the running deviation");
  f("initial_innovation_Nm", rls.initial_innovation, kPositive, "standard deviation at the start");
  f("slowest_velocity_rad_s", c.slowest_velocity_rad_s, kNotNegative, "slower for longer is rest");
  f("still_after_s", c.still_after_s, kNotNegative, "and rest teaches nothing");
}

void Describe(config::Fields& f, RlsConfig& c, const esn::WeightsPaths& given) {
  std::filesystem::path model;
  c.sea = esn::DescribeWeights(f, "sea_weights", given.sea);
  c.pea = esn::DescribeWeights(f, "pea_weights", given.pea);
  if (f.reads() && !c.sea && !c.pea) {
    f.Fail("pea_weights", "missing, expected sea_weights or pea_weights or both");
  }
  f.Need("model", model, "model file: drive term, and the balance that carries torques over");
  if (f.reads()) c.robot = actuator::LoadRobotModel(model);
  CheckOutputs(f, "sea_weights", c.sea, c.robot);
  CheckOutputs(f, "pea_weights", c.pea, c.robot);
  f.Word("torque_from", c.torque_from,
         {{"measured", TorqueFrom::kMeasured}, {"command", TorqueFrom::kCommand}},
         "drive torque from the measured current, or from the command");
  Describe(f, c.target, c.robot);
  Describe(f, c.adapter);
}

RlsConfig LoadRlsConfig(const std::filesystem::path& path, const esn::WeightsPaths& given) {
  return config::Read<RlsConfig>(config::Section::Load(path, kSchema), given);
}

}  // namespace sinew::rls

#include "components/learn/rls/file/rls_config.h"

#include <string>

#include "components/base/config/config.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::rls {
namespace {

constexpr std::string_view kSchema = "sinew-rls-participant/1";

void CheckOutputs(const config::Section& s, const char* key,
                  const std::optional<esn::Weights>& weights, const actuator::RobotModel& robot) {
  if (!weights) return;
  if (weights->target != "drive_torque_Nm") {
    s.Fail(key, "target '" + weights->target + "', expected 'drive_torque_Nm'");
  }
  if (static_cast<std::size_t>(weights->output_count()) > robot.joints.size()) {
    s.Fail(key, std::to_string(weights->output_count()) +
                    " outputs, expected at most one for each of the " +
                    std::to_string(robot.joints.size()) + " joints of the model");
  }
}

}  // namespace

RlsConfig LoadRlsConfig(const std::filesystem::path& path, const esn::WeightsPaths& given) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file of schema " + std::string(kSchema));
  }
  const config::Section s = config::Section::Load(path, kSchema);
  RlsConfig config;
  config.sea = esn::LoadWeightsFor(s, "sea_weights", given.sea);
  config.pea = esn::LoadWeightsFor(s, "pea_weights", given.pea);
  if (!config.sea && !config.pea)
    s.Fail("pea_weights", "missing, expected sea_weights or pea_weights or both");
  config.robot = actuator::LoadRobotModel(s.ExistingPath("model"));
  CheckOutputs(s, "sea_weights", config.sea, config.robot);
  CheckOutputs(s, "pea_weights", config.pea, config.robot);
  config.torque_from = s.ChoiceOr("torque_from", "measured", {"measured", "command"}) == "measured"
                           ? TorqueFrom::kMeasured
                           : TorqueFrom::kCommand;
  TargetConfig& target = config.target;
  target.carry_over = s.BoolOr("carry_over", target.carry_over);
  target.half_window_ticks =
      static_cast<int>(s.IntegerOr("half_window_ticks", target.half_window_ticks, {1, 100}));
  target.motion_from_motor = s.ChoiceOr("motion_from", "motor", {"motor", "output"}) == "motor";
  target.smoothing_rad_s = s.NumberOr("smoothing_rad_s", target.smoothing_rad_s, config::kPositive);
  target.stance = esn::ReadStance(s, config.robot);
  AdapterConfig& adapter = config.adapter;
  Config& rls = adapter.rls;
  constexpr double kNearlyOne = 1.0 - 1e-12;
  rls.forgetting = s.NumberOr("forgetting", rls.forgetting, {1e-6, 1.0});
  rls.directional = s.BoolOr("directional", rls.directional);
  rls.prior_precision = s.NumberOr("prior_precision", rls.prior_precision, config::kPositive);
  rls.leak = s.NumberOr("leak", rls.leak, config::kNotNegative);
  rls.clip_sigmas = s.NumberOr("clip_sigmas", rls.clip_sigmas, config::kNotNegative);
  rls.innovation_memory =
      s.NumberOr("innovation_memory", rls.innovation_memory, {1e-12, kNearlyOne});
  rls.initial_innovation =
      s.NumberOr("initial_innovation_Nm", rls.initial_innovation, config::kPositive);
  adapter.slowest_velocity_rad_s =
      s.NumberOr("slowest_velocity_rad_s", adapter.slowest_velocity_rad_s, config::kNotNegative);
  adapter.still_after_s = s.NumberOr("still_after_s", adapter.still_after_s, config::kNotNegative);
  s.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::rls

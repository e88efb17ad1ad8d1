#include "components/learn/esn/file/esn_config.h"

#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/payloads/payloads.h"

namespace sinew::esn {
namespace {

constexpr std::string_view kSchema = "sinew-esn-participant/1";

InverseDynamicsConfig ReadInverseDynamics(const config::Section& s,
                                          const std::filesystem::path& model) {
  InverseDynamicsConfig config;
  const std::filesystem::path named = s.ExistingPath("model");
  config.robot = actuator::LoadRobotModel(model.empty() ? named : model);
  config.smoothing_rad_s = s.NumberOr("smoothing_rad_s", config.smoothing_rad_s, config::kPositive);
  if (s.ChoiceOr("state", "reference", {"reference", "measured"}) == "measured") {
    config.state = MotionState::kMeasured;
  }
  const config::Section feedback = s.ChildOrEmpty("feedback");
  config.proportional_1_s2 = feedback.NumberOr("proportional_1_s2", 0.0, config::kNotNegative);
  config.derivative_1_s = feedback.NumberOr("derivative_1_s", 0.0, config::kNotNegative);
  feedback.RejectUnknownKeys();
  config.stance = ReadStance(s, config.robot);
  return config;
}

}  // namespace

std::optional<StanceConfig> ReadStance(const config::Section& s,
                                       const actuator::RobotModel& robot) {
  if (s.ChoiceOr("stance", "none", {"none", "double"}) == "none") return std::nullopt;
  const std::filesystem::path urdf = s.ExistingPath("urdf");
  StanceConfig stance;
  try {
    stance.chain =
        arm::WithPayloads(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()), robot.payloads);
  } catch (const std::invalid_argument& error) {
    s.Fail("model", error.what());
  }
  return stance;
}

std::optional<Weights> LoadWeightsFor(const config::Section& s, const char* key,
                                      const std::filesystem::path& given) {
  // Asked for in any case, so that the key counts as known; the file need not exist when another is
  // given.
  const bool in_file = s.Has(key);
  if (!given.empty()) {
    if (in_file) (void)s.Text(key);
    return LoadWeights(given);
  }
  if (!in_file) return std::nullopt;
  return LoadWeights(s.ExistingPath(key));
}

EsnConfig LoadEsnConfig(const std::filesystem::path& path, const WeightsPaths& given,
                        const std::filesystem::path& model) {
  if (path.empty() && given.sea.empty() && given.pea.empty()) {
    throw UsageError("--config: missing, expected a file of schema " + std::string(kSchema) +
                     ", or --sea-weights or --pea-weights");
  }
  const config::Section s = path.empty() ? config::Section::Empty("the command line")
                                         : config::Section::Load(path, kSchema);
  EsnConfig config;
  const std::string mode = s.ChoiceOr("mode", "network", {"network", "inverse_dynamics"});
  if (mode == "network") {
    config.mode = EsnConfig::Mode::kNetwork;
    config.sea = LoadWeightsFor(s, "sea_weights", given.sea);
    config.pea = LoadWeightsFor(s, "pea_weights", given.pea);
    if (!config.sea && !config.pea)
      s.Fail("mode", "network, expected sea_weights or pea_weights or both");
    config.adaptation = s.BoolOr("adaptation", false);
  } else {
    config.mode = EsnConfig::Mode::kInverseDynamics;
    config.inverse_dynamics = ReadInverseDynamics(s, model);
  }
  s.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::esn

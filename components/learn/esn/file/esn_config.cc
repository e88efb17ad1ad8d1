#include "components/learn/esn/file/esn_config.h"

#include <stdexcept>
#include <string>

#include "components/bodies/links/file/urdf_file.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/payloads/payloads.h"

namespace sinew::esn {
// Sets the stand-in from the model file, or from `model` in its place.
static void Describe(config::Fields& f, InverseDynamicsConfig& c,
                     const std::filesystem::path& model) {
  std::filesystem::path named;
  f.Need("model", named, "model file");
  if (f.reads()) c.robot = actuator::LoadRobotModel(model.empty() ? named : model);
  f("smoothing_rad_s", c.smoothing_rad_s, config::kPositive, "dry friction turns over it");
  f.Word("state", c.state,
         {{"reference", MotionState::kReference}, {"measured", MotionState::kMeasured}},
         "whose position and velocity count");
  f.Object("feedback", "added to the reference's acceleration", [&](config::Fields& feedback) {
    feedback("proportional_1_s2", c.proportional_1_s2, config::kNotNegative,
             "times the error of position");
    feedback("derivative_1_s", c.derivative_1_s, config::kNotNegative, "times that of velocity");
  });
  c.stance = DescribeStance(f, c.robot);
}

std::optional<StanceConfig> DescribeStance(config::Fields& f, const actuator::RobotModel& robot) {
  bool on_both = false;
  std::filesystem::path urdf;
  const auto stands =
      f.Word("stance", on_both, {{"none", false}, {"double", true}},
             "double: the rigid bodies of a biped on both soles are part of the balance");
  if (const auto both = stands.Is({"double"})) f.Need("urdf", urdf, "of these bodies");
  if (!f.reads() || !on_both) return std::nullopt;
  StanceConfig stance;
  try {
    stance.chain =
        arm::WithPayloads(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()), robot.payloads);
  } catch (const std::invalid_argument& error) {
    f.Fail("model", error.what());
  }
  return stance;
}

std::optional<Weights> DescribeWeights(config::Fields& f, const char* key,
                                       const std::filesystem::path& given) {
  std::filesystem::path path;
  f.PathOr(key, path, given, "weights, schema sinew-esn/1; one of the two at least");
  return path.empty() ? std::nullopt : std::optional(LoadWeights(path));
}

void Describe(config::Fields& f, EsnConfig& c, const WeightsPaths& given,
              const std::filesystem::path& model) {
  using Mode = EsnConfig::Mode;
  const auto mode = f.Word(
      "mode", c.mode, {{"network", Mode::kNetwork}, {"inverse_dynamics", Mode::kInverseDynamics}},
      "echo state networks, or the stand-in from a model file");
  if (const auto network = mode.Is({"network"})) {
    c.sea = DescribeWeights(f, "sea_weights", given.sea);
    c.pea = DescribeWeights(f, "pea_weights", given.pea);
    f("adaptation", c.adaptation, "waits for the readout of the tick before: needs sinew-rls");
    f.Require(c.sea || c.pea, "mode", "network, expected sea_weights or pea_weights or both");
  }
  if (const auto inverse = mode.Is({"inverse_dynamics"})) Describe(f, c.inverse_dynamics, model);
}

EsnConfig LoadEsnConfig(const std::filesystem::path& path, const WeightsPaths& given,
                        const std::filesystem::path& model) {
  if (path.empty() && given.sea.empty() && given.pea.empty()) {
    throw UsageError("--config: missing, expected a file of schema " + std::string(kEsnSchema) +
                     ", or --sea-weights or --pea-weights");
  }
  return config::Read<EsnConfig>(path.empty() ? config::Section::Empty("the command line")
                                              : config::Section::Load(path, kEsnSchema),
                                 given, model);
}

}  // namespace sinew::esn

#include "components/esn/file/esn_config.h"

#include <string>

#include "components/actuator/file/model_file.h"
#include "components/config/config.h"
#include "components/esn/file/weights_file.h"

namespace sinew::esn {
namespace {

constexpr std::string_view kSchema = "sinew-esn-participant/1";

}  // namespace

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

EsnConfig LoadEsnConfig(const std::filesystem::path& path, const WeightsPaths& given) {
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
    config.robot = actuator::LoadRobotModel(s.ExistingPath("model"));
    config.smoothing_rad_s =
        s.NumberOr("smoothing_rad_s", config.smoothing_rad_s, config::kPositive);
  }
  s.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::esn

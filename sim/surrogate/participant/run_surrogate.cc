#include "sim/surrogate/participant/run_surrogate.h"

#include <spdlog/spdlog.h>

#include "components/robot/provider/participant/run_provider.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"

namespace sinew::surrogate {

void RunSurrogate(const node::Options& options, node::StopFlag& stop,
                  const provider::ProviderOptions& provider_options,
                  const std::vector<std::string>& effects) {
  const config::Section file = OpenSurrogate(options.config_path);
  RigParameters rig = ReadRig(file);
  const provider::GuardConfig guard = provider::LoadGuardConfig(file.ChildOrEmpty("guard"));
  file.RejectUnknownKeys();
  if (!effects.empty()) rig.effects = ParseEffects(effects);
  rig.seed = options.seed;
  for (const auto& effect : rig.effects) {
    spdlog::info("undeclared effect {} of size {} from {} s", effect.name, effect.size,
                 effect.from_s);
  }
  Surrogate plant(rig);
  provider::RunProvider(options, stop, provider_options, guard, plant);
}

}  // namespace sinew::surrogate

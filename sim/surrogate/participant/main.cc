// sinew-surrogate: the lab's rig as a state provider, played by physics of its own.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "components/node/options.h"
#include "components/provider/participant/run_provider.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/surrogate.h"

int main(int argc, char** argv) {
  using namespace sinew;
  provider::ProviderOptions provider_options;
  std::vector<std::string> effects;
  const auto add_options = [&](CLI::App& app) {
    provider::AddProviderOptions(app, &provider_options);
    app.add_option("--effect", effects,
                   "Undeclared effect: NAME, NAME=SIZE or NAME=SIZE@SECONDS; may be repeated")
        ->capture_default_str();
    app.add_flag_callback(
        "--list-effects",
        [] {
          std::cout << surrogate::DescribeEffects();
          throw CLI::Success();
        },
        "Print the undeclared effects and leave");
  };
  const auto body = [&](const node::Options& options, node::StopFlag& stop) {
    const config::Section file = surrogate::OpenSurrogate(options.config_path);
    surrogate::RigParameters rig = surrogate::ReadRig(file);
    const provider::GuardConfig guard = provider::LoadGuardConfig(file.ChildOrEmpty("guard"));
    file.RejectUnknownKeys();
    if (!effects.empty()) rig.effects = surrogate::ParseEffects(effects);
    rig.seed = options.seed;
    for (const auto& effect : rig.effects) {
      spdlog::info("undeclared effect {} of size {} from {} s", effect.name, effect.size,
                   effect.from_s);
    }
    surrogate::Surrogate plant(rig);
    provider::RunProvider(options, stop, provider_options, guard, plant);
  };
  return node::RunParticipant(
      argc, argv, "surrogate",
      "Plays the lab's rig: motor, gear with play, pneumatic element, sensors.", body, add_options);
}

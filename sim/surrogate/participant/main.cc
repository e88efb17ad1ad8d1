// sinew-surrogate: the lab's rig as a state provider, played by physics of its own.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "sim/surrogate/file/surrogate_file.h"
#include "sim/surrogate/participant/run_surrogate.h"

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
    surrogate::RunSurrogate(options, stop, provider_options, effects);
  };
  return node::RunParticipant(
      argc, argv, "surrogate",
      "Plays the lab's rig: motor, gear with play, pneumatic element, sensors.", body, add_options);
}

// sinew-compose: a state provider and participants of its chain as one process with one thread:
// read, update, write. The same classes and topics as of separate processes.
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "components/robot/provider/participant/provider_options.h"
#include "components/topics/node/options.h"
#include "sim/surrogate/participant/run_surrogate.h"
#include "tools/compose/chain.h"

namespace {

using namespace sinew;

struct ComposeOptions {
  std::string provider = "sinew-surrogate";
  std::vector<std::string> components;
  std::vector<std::string> effects;
  provider::ProviderOptions of_provider;
};

void AddComposeOptions(CLI::App& app, ComposeOptions* compose) {
  provider::AddProviderOptions(app, &compose->of_provider);
  app.add_option("--provider", compose->provider, "Program whose place the state provider takes")
      ->check(CLI::IsMember({"sinew-surrogate"}))
      ->capture_default_str();
  app.add_option("--component", compose->components,
                 "NAME=PROGRAM=CONFIG of a participant; may be repeated");
  app.add_option("--effect", compose->effects, "Of the surrogate: see sinew-surrogate --help");
}

void Run(const node::Options& options, node::StopFlag& stop, ComposeOptions* compose) {
  std::vector<compose::Part> parts;
  for (const std::string& text : compose->components) parts.push_back(compose::ParsePart(text));
  compose::Chain chain(options, stop, parts);
  compose->of_provider.composed = &chain;
  node::Options of_provider = options;
  of_provider.component = compose->provider.substr(std::string("sinew-").size());
  of_provider.composition = &chain.composition();
  surrogate::RunSurrogate(of_provider, stop, compose->of_provider, compose->effects);
}

}  // namespace

int main(int argc, char** argv) {
  ComposeOptions compose;
  return node::RunParticipant(
      argc, argv, "compose",
      "A state provider and participants of its chain in one thread. Usually started by 'sinew "
      "launch --compose'.",
      [&](const node::Options& options, node::StopFlag& stop) { Run(options, stop, &compose); },
      [&](CLI::App& app) { AddComposeOptions(app, &compose); });
}

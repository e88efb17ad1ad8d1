// sinew-rls: adapts the readout of sinew-esn's networks while the robot moves.
#include <spdlog/spdlog.h>

#include "components/node/node.h"
#include "components/node/tick_loop.h"
#include "components/rls/participant/adaptation.h"

int main(int argc, char** argv) {
  using namespace sinew;
  esn::WeightsPaths given;
  const auto body = [&given](const node::Options& options, node::StopFlag& stop) {
    rls::Adaptation adaptation(rls::LoadRlsConfig(options.config_path, given));

    node::Node node(options);
    node::TickLoop loop(node, stop);
    rls::Inputs inputs(loop);
    auto readout = node.MakeWriter(node::kReadout);
    auto state = node.MakeWriter(node::kAdaptationState);
    while (const auto tick = loop.Next()) {
      const rls::Outputs outputs = adaptation.Step(inputs, *tick);
      loop.Publish(readout, outputs.readout, *tick);
      loop.Publish(state, outputs.adaptation, *tick);
    }
    spdlog::info("{} updates", adaptation.updates());
  };
  return node::RunParticipant(
      argc, argv, "rls", "Adaptation of the networks' readout by recursive least squares", body,
      [&given](CLI::App& app) {
        node::AddOption(app, "--sea-weights", &given.sea,
                        "Weights of the network inside the backlash");
        node::AddOption(app, "--pea-weights", &given.pea, "Weights of the network outside");
      });
}

// sinew-esn: the drive torque that the reference motion needs, every tick, from the network the
// regime chooses or from the grey-box model.
#include <spdlog/spdlog.h>

#include <stdexcept>

#include "components/esn/file/esn_config.h"
#include "components/esn/participant/inference.h"
#include "components/node/node.h"
#include "components/node/tick_loop.h"

int main(int argc, char** argv) {
  using namespace sinew;
  esn::WeightsPaths given;
  const auto body = [&given](const node::Options& options, node::StopFlag& stop) {
    const esn::EsnConfig config = esn::LoadEsnConfig(options.config_path, given);
    esn::Inference inference(config);

    node::Node node(options);
    node::TickLoop loop(node, stop);
    esn::Inputs inputs(loop, inference);
    auto prediction = node.MakeWriter(node::kTorquePrediction);
    auto reservoir = node.MakeWriter(node::kReservoirState);
    while (const auto tick = loop.Next()) {
      const esn::Outputs outputs = inference.Step(inputs, *tick);
      loop.Publish(prediction, outputs.prediction, *tick);
      loop.Publish(reservoir, outputs.reservoir, *tick);
    }
    spdlog::info("{} readouts taken, {} refused", inference.readouts_taken(),
                 inference.readouts_refused());
  };
  return node::RunParticipant(
      argc, argv, "esn", "Torque prediction by echo state networks, or by the model", body,
      [&given](CLI::App& app) {
        node::AddOption(app, "--sea-weights", &given.sea,
                        "Weights of the network inside the backlash");
        node::AddOption(app, "--pea-weights", &given.pea, "Weights of the network outside");
      });
}

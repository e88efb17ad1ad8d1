// sinew-inverse-dynamics: stands in for sinew-esn: the torque that the reference motion needs by
// the model file. It has no reservoir, so reservoir_state is not published.
#include "components/learn/esn/file/esn_config.h"
#include "components/learn/esn/participant/inference.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"
#include "sim/stand_ins/participant/stands_in.h"

namespace {

using namespace sinew;

void Run(const node::Options& options, node::StopFlag& stop,
         const std::filesystem::path& model_path) {
  const esn::EsnConfig config = esn::LoadEsnConfig(options.config_path, {}, model_path);
  if (config.mode != esn::EsnConfig::Mode::kInverseDynamics) {
    throw UsageError(options.config_path.string() +
                     ": key 'mode': network, expected inverse_dynamics; sinew-esn runs networks");
  }
  esn::Inference inference(config);

  node::Node node(stand_ins::StandsInFor("esn", options));
  node::TickLoop loop(node, stop);
  esn::Inputs inputs(loop, inference);
  auto prediction = node.MakeWriter(node::kTorquePrediction);
  node::OtherOwner owner(node, node::kTorquePrediction);
  while (const auto tick = loop.Next()) {
    owner.Watch(*tick);
    loop.Publish(prediction, inference.Step(inputs, *tick).prediction, *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace sinew;
  std::filesystem::path model_path;
  return node::RunParticipant(
      argc, argv, "inverse-dynamics",
      "Stands in for sinew-esn: the torque of the reference motion by the model file.",
      [&](const node::Options& options, node::StopFlag& stop) { Run(options, stop, model_path); },
      [&](CLI::App& app) {
        node::AddOption(app, "--model", &model_path,
                        "Model file that takes the place of the one the configuration names");
      });
}

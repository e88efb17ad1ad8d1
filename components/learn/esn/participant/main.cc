// sinew-esn: the drive torque that the reference motion needs, every tick, from the network the
// regime chooses or from the grey-box model.
#include "components/learn/esn/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  esn::WeightsPaths given;
  return node::RunParticipant(
      argc, argv, "esn", "Torque prediction by echo state networks, or by the model",
      [&given](const node::Options& options, node::StopFlag& stop) {
        esn::MakeEsn(options, stop, given)->Run();
      },
      [&given](CLI::App& app) {
        node::AddOption(app, "--sea-weights", &given.sea,
                        "Weights of the network inside the backlash");
        node::AddOption(app, "--pea-weights", &given.pea, "Weights of the network outside");
      });
}

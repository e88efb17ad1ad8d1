// sinew-rls: adapts the readout of sinew-esn's networks while the robot moves.
#include "components/learn/rls/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  esn::WeightsPaths given;
  return node::RunParticipant(
      argc, argv, "rls", "Adaptation of the networks' readout by recursive least squares",
      [&given](const node::Options& options, node::StopFlag& stop) {
        rls::MakeRls(options, stop, given)->Run();
      },
      [&given](CLI::App& app) {
        node::AddOption(app, "--sea-weights", &given.sea,
                        "Weights of the network inside the backlash");
        node::AddOption(app, "--pea-weights", &given.pea, "Weights of the network outside");
      });
}

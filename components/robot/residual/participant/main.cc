// sinew-residual: publishes `residual`: predicted against measured torque, and whether that
// changed.
#include "components/robot/residual/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  std::filesystem::path model_path;
  return node::RunParticipant(
      argc, argv, "residual", "Detects when the robot no longer follows its model file.",
      [&](const node::Options& options, node::StopFlag& stop) {
        residual::MakeResidual(options, stop, model_path)->Run();
      },
      [&](CLI::App& app) {
        node::AddOption(app, "--model", &model_path,
                        "Model file that takes the place of the one the configuration names");
      });
}

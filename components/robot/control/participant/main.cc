// sinew-control: publishes `joint_command`: position, PID, PID with a model, PID with networks by
// regime.
#include "components/robot/control/participant/component.h"

int main(int argc, char** argv) {
  using namespace sinew;
  std::filesystem::path model_path;
  return node::RunParticipant(
      argc, argv, "control", "Makes the joints follow their references.",
      [&](const node::Options& options, node::StopFlag& stop) {
        control::MakeControl(options, stop, model_path)->Run();
      },
      [&](CLI::App& app) {
        node::AddOption(app, "--model", &model_path,
                        "Model file that takes the place of the one the configuration names");
      });
}

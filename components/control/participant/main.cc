// sinew-control: publishes `joint_command`: position, PID, PID with a model, PID with networks by
// regime.
#include <spdlog/spdlog.h>

#include "components/control/participant/translate.h"
#include "components/node/options.h"

namespace {

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop,
         const std::filesystem::path& model_path) {
  using namespace sinew;
  if (options.config_path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-control/1");
  }
  const control::ControlConfig config = control::LoadControl(options.config_path, model_path);
  control::RobotController controller(config.joints);

  node::Node node(options);
  node::TickLoop loop(node, stop);
  control::ControlInputs inputs(node, loop, config);
  auto output = node.MakeWriter(node::kJointCommand);
  std::string reported;
  while (const auto tick = loop.Next()) {
    inputs.FollowOwner(&controller);
    const control::RobotInput input = inputs.Gather(*tick);
    const control::RobotOutput result = controller.Step(input);
    const msg::JointCommand command = inputs.ToMessage(result, input);
    inputs.Made(*tick, command);
    loop.Publish(output, command, *tick);
    if (const std::string fault = control::FaultLine(result); fault != reported) {
      reported = fault;
      if (!reported.empty()) spdlog::error("{}", reported);
      node.SetState(reported.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                    reported);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path model_path;
  return sinew::node::RunParticipant(
      argc, argv, "control", "Makes the joints follow their references.",
      [&](const auto& options, auto& stop) { Run(options, stop, model_path); },
      [&](CLI::App& app) {
        sinew::node::AddOption(
            app, "--model", &model_path,
            "Model file that takes the place of the one the configuration names");
      });
}

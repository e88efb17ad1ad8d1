// sinew-residual: publishes `residual`: predicted against measured torque, and whether that
// changed.
#include <spdlog/spdlog.h>

#include "components/node/options.h"
#include "components/node/tick_loop.h"
#include "components/residual/participant/translate.h"

namespace {

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop,
         const std::filesystem::path& model_path) {
  using namespace sinew;
  if (options.config_path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-residual/1");
  }
  residual::RobotResidual robot(residual::LoadResidual(options.config_path, model_path));

  node::Node node(options);
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& actuator = loop.AddInput(node::kActuatorState);
  auto output = node.MakeWriter(node::kResidual);
  std::string reported, logged;
  while (const auto tick = loop.Next()) {
    robot.Step(*tick, state.value(), actuator);
    loop.Publish(output, robot.ToMessage(*tick), *tick);
    if (const std::string line = robot.Line(true); line != reported) {
      reported = line;
      node.SetState(node::Node::State::kActive, reported);
    }
    if (const std::string line = robot.Line(false); line != logged) {
      logged = line;
      spdlog::info("{}", reported.empty() ? "watching" : reported);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::filesystem::path model_path;
  return sinew::node::RunParticipant(
      argc, argv, "residual", "Detects when the robot no longer follows its model file.",
      [&](const auto& options, auto& stop) { Run(options, stop, model_path); },
      [&](CLI::App& app) {
        sinew::node::AddOption(
            app, "--model", &model_path,
            "Model file that takes the place of the one the configuration names");
      });
}

// sinew-pneumatics: publishes `valve_command` and `pneumatic_state`: holds pressures or
// stiffnesses.
#include <spdlog/spdlog.h>

#include "components/node/options.h"
#include "components/pneumatics/participant/translate.h"

namespace {

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop) {
  using namespace sinew;
  if (options.config_path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-pneumatics/1");
  }
  const pneumatics::PneumaticsConfig config = pneumatics::LoadPneumatics(options.config_path);

  node::Node node(options);
  node::TickLoop loop(node, stop);
  pneumatics::RobotPneumatics robot(node, loop, config);
  auto command = node.MakeWriter(node::kValveCommand);
  auto state = node.MakeWriter(node::kPneumaticState);
  std::string reported;
  while (const auto tick = loop.Next()) {
    robot.Step(*tick);
    loop.Publish(command, robot.Command(), *tick);
    loop.Publish(state, robot.State(*tick), *tick);
    if (const std::string trouble = robot.Trouble(); trouble != reported) {
      reported = trouble;
      if (!reported.empty()) spdlog::error("{}", reported);
      node.SetState(reported.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                    reported);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(
      argc, argv, "pneumatics", "Holds the pressure or stiffness of the pneumatic elements.", Run);
}

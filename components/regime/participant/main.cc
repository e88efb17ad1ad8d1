// sinew-regime: publishes `regime`, inside the backlash or outside; asks for motion in its setup
// phase.
#include <spdlog/spdlog.h>

#include <optional>

#include "components/node/options.h"
#include "components/node/tick_loop.h"
#include "components/regime/file/regime_file.h"
#include "components/regime/participant/translate.h"

namespace {

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop) {
  using namespace sinew;
  if (options.config_path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-regime/1");
  }
  const regime::RegimeConfig config = regime::LoadRegime(options.config_path);
  regime::RobotRegime robot(config.joints);

  node::Node node(options);
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& actuator = loop.AddInput(node::kActuatorState);
  auto output = node.MakeWriter(node::kRegime);
  std::optional<node::Writer<msg::MotionRequest>> requests;
  if (config.requests_motion()) requests.emplace(node.MakeWriter(node::kMotionRequest));
  std::string reported;
  while (const auto tick = loop.Next()) {
    robot.Step(*tick, state.value(), actuator);
    loop.Publish(output, regime::ToMessage(robot, *tick), *tick);
    if (requests) loop.Publish(*requests, regime::ToRequest(robot), *tick);
    if (const std::string trouble = robot.Trouble(); trouble != reported) {
      reported = trouble;
      if (!reported.empty()) spdlog::warn("{}", reported);
      node.SetState(reported.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                    reported);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(argc, argv, "regime",
                                     "Inside the backlash (SEA) or outside (PEA), Fig 7.1.", Run);
}

#include "components/control/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/control/participant/translate.h"

namespace sinew::control {
namespace {

ControlConfig LoadConfig(const std::filesystem::path& path,
                         const std::filesystem::path& model_path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-control/1");
  }
  return LoadControl(path, model_path);
}

class ControlComponent final : public node::Component {
 public:
  ControlComponent(const node::Options& options, node::StopFlag& stop, const ControlConfig& config)
      : controller_(config.joints),
        node_(options),
        loop_(node_, stop),
        inputs_(node_, loop_, config) {}

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    inputs_.FollowOwner(*tick, &controller_);
    const RobotInput input = inputs_.Gather(*tick);
    const RobotOutput result = controller_.Step(input);
    const msg::JointCommand command = inputs_.ToMessage(result, input);
    inputs_.Made(*tick, command);
    loop_.Publish(output_, command, *tick);
    Report(FaultLine(result));
    return true;
  }

 private:
  void Report(const std::string& fault) {
    if (fault == reported_) return;
    reported_ = fault;
    if (!fault.empty()) spdlog::error("{}", fault);
    node_.SetState(fault.empty() ? node::Node::State::kActive : node::Node::State::kFault, fault);
  }

  RobotController controller_;
  node::Node node_;
  node::TickLoop loop_;
  ControlInputs inputs_;
  node::Writer<msg::JointCommand> output_ = node_.MakeWriter(node::kJointCommand);
  std::string reported_;
};

}  // namespace

std::unique_ptr<node::Component> MakeControl(const node::Options& options, node::StopFlag& stop,
                                             const std::filesystem::path& model_path) {
  return std::make_unique<ControlComponent>(options, stop,
                                            LoadConfig(options.config_path, model_path));
}

}  // namespace sinew::control

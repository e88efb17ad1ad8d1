#include "components/robot/control/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/robot/control/participant/translate.h"
#include "components/topics/node/snapshot.h"

namespace sinew::control {
namespace {

ControlConfig LoadConfig(const std::filesystem::path& path,
                         const std::filesystem::path& model_path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-control/1");
  }
  return LoadControl(path, model_path);
}

// Of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kControlStateVersion = 1;

class ControlComponent final : public node::Component {
 public:
  ControlComponent(const node::Options& options, node::StopFlag& stop, const ControlConfig& config)
      : controller_(config.joints),
        node_(options, config.joint_names),
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
    snapshots_.Cycle(*tick);
    Report(FaultLine(result));
    return true;
  }
  void Resume(const node::SavedState& saved) override {
    node::SkipCycle(loop_);
    snapshots_.Restore(saved);
  }
  void Exchange(types::StateArchive& archive) { archive(controller_, inputs_); }

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
  node::Snapshots<ControlComponent> snapshots_{node_, kControlStateVersion, this};
  std::string reported_;
};

}  // namespace

std::unique_ptr<node::Component> MakeControl(const node::Options& options, node::StopFlag& stop,
                                             const std::filesystem::path& model_path) {
  return std::make_unique<ControlComponent>(options, stop,
                                            LoadConfig(options.config_path, model_path));
}

}  // namespace sinew::control

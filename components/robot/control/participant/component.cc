#include "components/robot/control/participant/component.h"

#include "components/robot/control/participant/translate.h"
#include "components/topics/node/tick_component.h"

namespace sinew::control {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kControlStateVersion = 1;

class ControlComponent final : public node::TickComponent {
 public:
  ControlComponent(const node::Options& options, node::StopFlag& stop, const ControlConfig& config)
      : TickComponent(options, stop, config.joint_names),
        controller_(config.joints),
        inputs_(node(), loop(), config) {
    Keep(kControlStateVersion, this);
  }
  void Exchange(types::StateArchive& archive) { archive(controller_, inputs_); }

 private:
  void Compute(node::Tick& tick) override {
    inputs_.FollowOwner(tick, &controller_);
    const RobotInput input = inputs_.Gather(tick);
    const RobotOutput result = controller_.Step(input);
    const msg::JointCommand command = inputs_.ToMessage(result, input);
    inputs_.Made(tick, command);
    loop().Publish(output_, command, tick);
    Report(FaultLine(result));
  }

  RobotController controller_;
  ControlInputs inputs_;
  node::Writer<msg::JointCommand> output_ = node().MakeWriter(node::kJointCommand);
};

}  // namespace

std::unique_ptr<node::Component> MakeControl(const node::Options& options, node::StopFlag& stop,
                                             const std::filesystem::path& model_path) {
  return std::make_unique<ControlComponent>(options, stop,
                                            LoadControl(options.config_path, model_path));
}

}  // namespace sinew::control

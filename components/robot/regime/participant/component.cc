#include "components/robot/regime/participant/component.h"

#include <optional>

#include "components/robot/regime/file/regime_file.h"
#include "components/robot/regime/participant/translate.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_component.h"

namespace sinew::regime {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kRegimeStateVersion = 1;

class RegimeComponent final : public node::TickComponent {
 public:
  RegimeComponent(const node::Options& options, node::StopFlag& stop, const RegimeConfig& config)
      : TickComponent(options, stop), robot_(config.joints) {
    if (config.requests_motion()) requests_.emplace(node().MakeWriter(node::kMotionRequest));
    Keep(kRegimeStateVersion, &robot_);
  }

 private:
  void Compute(node::Tick& tick) override {
    robot_.Follow(tick, &owner_);
    robot_.Step(tick, state_.value(), actuator_);
    loop().Publish(output_, ToMessage(robot_, tick), tick);
    if (requests_) loop().Publish(*requests_, ToRequest(robot_), tick);
    Report(robot_.Trouble());
  }

  RobotRegime robot_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop().AddInput(node::kActuatorState);
  node::Writer<msg::RegimeState> output_ = node().MakeWriter(node::kRegime);
  std::optional<node::Writer<msg::MotionRequest>> requests_;
  node::OtherOwner<msg::RegimeState> owner_{node(), node::kRegime};
};

}  // namespace

std::unique_ptr<node::Component> MakeRegime(const node::Options& options, node::StopFlag& stop) {
  return std::make_unique<RegimeComponent>(options, stop, LoadRegime(options.config_path));
}

}  // namespace sinew::regime

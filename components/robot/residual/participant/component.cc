#include "components/robot/residual/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/robot/residual/participant/translate.h"
#include "components/topics/node/tick_component.h"

namespace sinew::residual {
namespace {

class ResidualComponent final : public node::TickComponent {
 public:
  ResidualComponent(const node::Options& options, node::StopFlag& stop, ResidualConfig config)
      : TickComponent(options, stop), robot_(std::move(config)) {}

 private:
  void Compute(node::Tick& tick) override {
    robot_.Step(tick, state_.value(), actuator_);
    loop().Publish(output_, robot_.ToMessage(tick), tick);
    if (const std::string line = robot_.Line(true); line != reported_) {
      reported_ = line;
      node().SetState(robot_.unfit() ? node::Node::State::kFault : node::Node::State::kActive,
                      reported_);
    }
    if (const std::string line = robot_.Line(false); line != logged_) {
      logged_ = line;
      if (robot_.unfit()) {
        spdlog::error("{}", reported_);
      } else {
        spdlog::info("{}", reported_.empty() ? "watching" : reported_);
      }
    }
  }

  RobotResidual robot_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop().AddInput(node::kActuatorState);
  node::Writer<msg::ResidualState> output_ = node().MakeWriter(node::kResidual);
  std::string reported_, logged_;
};

}  // namespace

std::unique_ptr<node::Component> MakeResidual(const node::Options& options, node::StopFlag& stop,
                                              const std::filesystem::path& model_path) {
  return std::make_unique<ResidualComponent>(options, stop,
                                             LoadResidual(options.config_path, model_path));
}

}  // namespace sinew::residual

#include "components/robot/residual/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/robot/residual/participant/translate.h"

namespace sinew::residual {
namespace {

ResidualConfig LoadConfig(const std::filesystem::path& path,
                          const std::filesystem::path& model_path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-residual/1");
  }
  return LoadResidual(path, model_path);
}

class ResidualComponent final : public node::Component {
 public:
  ResidualComponent(const node::Options& options, node::StopFlag& stop, ResidualConfig config)
      : robot_(std::move(config)), node_(options), loop_(node_, stop) {}

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    robot_.Step(*tick, state_.value(), actuator_);
    loop_.Publish(output_, robot_.ToMessage(*tick), *tick);
    if (const std::string line = robot_.Line(true); line != reported_) {
      reported_ = line;
      node_.SetState(robot_.unfit() ? node::Node::State::kFault : node::Node::State::kActive,
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
    return true;
  }

 private:
  RobotResidual robot_;
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_ = loop_.AddInput(node::kJointState);
  node::TickInput<msg::ActuatorState>& actuator_ = loop_.AddInput(node::kActuatorState);
  node::Writer<msg::ResidualState> output_ = node_.MakeWriter(node::kResidual);
  std::string reported_, logged_;
};

}  // namespace

std::unique_ptr<node::Component> MakeResidual(const node::Options& options, node::StopFlag& stop,
                                              const std::filesystem::path& model_path) {
  return std::make_unique<ResidualComponent>(options, stop,
                                             LoadConfig(options.config_path, model_path));
}

}  // namespace sinew::residual

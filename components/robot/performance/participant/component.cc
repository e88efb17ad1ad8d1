#include "components/robot/performance/participant/component.h"

#include <spdlog/spdlog.h>

#include <string>

#include "components/robot/performance/participant/robot_meter.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::performance {
namespace {

PerformanceConfig LoadConfig(const std::filesystem::path& path) {
  if (path.empty()) {
    throw UsageError("--config: missing, expected a file with schema sinew-performance/1");
  }
  return LoadPerformance(path);
}

class PerformanceComponent final : public node::Component {
 public:
  PerformanceComponent(const node::Options& options, node::StopFlag& stop, PerformanceConfig config)
      : meter_(std::move(config)), node_(options), loop_(node_, stop) {
    if (meter_.reads_actuators()) actuator_ = &loop_.AddInput(node::kActuatorState);
  }

  bool Ready() override { return loop_.Ready(); }
  bool Step() override {
    const auto tick = loop_.Next();
    if (!tick) return false;
    TickMessages messages{.state = &state_.value()};
    if (reference_.fresh()) messages.reference = &reference_.value();
    if (actuator_ != nullptr && actuator_->fresh()) messages.actuator = &actuator_->value();
    meter_.Step(messages);
    loop_.Publish(output_, meter_.ToMessage(), *tick);
    Report(meter_.unfit());
    return true;
  }

 private:
  void Report(const std::string& unfit) {
    if (unfit == reported_) return;
    reported_ = unfit;
    if (!unfit.empty()) spdlog::error("{}", unfit);
    node_.SetState(unfit.empty() ? node::Node::State::kActive : node::Node::State::kFault, unfit);
  }

  RobotMeter meter_;
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_ = loop_.AddInput(node::kJointState);
  node::TickInput<msg::Reference>& reference_ = loop_.AddInput(node::kReference);
  node::TickInput<msg::ActuatorState>* actuator_ = nullptr;
  node::Writer<msg::PerformanceState> output_ = node_.MakeWriter(node::kPerformance);
  std::string reported_;
};

}  // namespace

std::unique_ptr<node::Component> MakePerformance(const node::Options& options,
                                                 node::StopFlag& stop) {
  return std::make_unique<PerformanceComponent>(options, stop, LoadConfig(options.config_path));
}

}  // namespace sinew::performance

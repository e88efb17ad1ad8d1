#include "components/robot/performance/participant/component.h"

#include "components/robot/performance/participant/robot_meter.h"
#include "components/topics/node/tick_component.h"

namespace sinew::performance {
namespace {

class PerformanceComponent final : public node::TickComponent {
 public:
  PerformanceComponent(const node::Options& options, node::StopFlag& stop, PerformanceConfig config)
      : TickComponent(options, stop), meter_(std::move(config)) {
    if (meter_.reads_actuators()) actuator_ = &loop().AddInput(node::kActuatorState);
  }

 private:
  void Compute(node::Tick& tick) override {
    TickMessages messages{.state = &state_.value()};
    if (reference_.fresh()) messages.reference = &reference_.value();
    if (actuator_ != nullptr && actuator_->fresh()) messages.actuator = &actuator_->value();
    meter_.Step(messages);
    loop().Publish(output_, meter_.ToMessage(), tick);
    Report(meter_.unfit());
  }

  RobotMeter meter_;
  node::TickInput<msg::JointState>& state_ = loop().AddInput(node::kJointState);
  node::TickInput<msg::Reference>& reference_ = loop().AddInput(node::kReference);
  node::TickInput<msg::ActuatorState>* actuator_ = nullptr;
  node::Writer<msg::PerformanceState> output_ = node().MakeWriter(node::kPerformance);
};

}  // namespace

std::unique_ptr<node::Component> MakePerformance(const node::Options& options,
                                                 node::StopFlag& stop) {
  return std::make_unique<PerformanceComponent>(options, stop,
                                                LoadPerformance(options.config_path));
}

}  // namespace sinew::performance

#include "components/robot/pneumatics/participant/component.h"

#include "components/robot/pneumatics/participant/translate.h"
#include "components/topics/node/tick_component.h"

namespace sinew::pneumatics {
namespace {

// Version of the fields of Exchange and of all that they contain.
constexpr std::uint32_t kPneumaticsStateVersion = 1;

class PneumaticsComponent final : public node::TickComponent {
 public:
  PneumaticsComponent(const node::Options& options, node::StopFlag& stop,
                      const PneumaticsConfig& config)
      : TickComponent(options, stop), robot_(node(), loop(), config) {
    Keep(kPneumaticsStateVersion, &robot_);
  }

 private:
  void Compute(node::Tick& tick) override {
    robot_.Step(tick);
    loop().Publish(command_, robot_.Command(), tick);
    loop().Publish(state_, robot_.State(tick), tick);
    Report(robot_.Trouble());
  }

  RobotPneumatics robot_;
  node::Writer<msg::ValveCommand> command_ = node().MakeWriter(node::kValveCommand);
  node::Writer<msg::PneumaticState> state_ = node().MakeWriter(node::kPneumaticState);
};

}  // namespace

std::unique_ptr<node::Component> MakePneumatics(const node::Options& options,
                                                node::StopFlag& stop) {
  return std::make_unique<PneumaticsComponent>(options, stop, LoadPneumatics(options.config_path));
}

}  // namespace sinew::pneumatics

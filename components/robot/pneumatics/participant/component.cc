#include "components/robot/pneumatics/participant/component.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/pneumatics.h>

#include <string>
#include <vector>

#include "components/base/types/joints.h"
#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/pneumatics/manager.h"
#include "components/robot/pneumatics/participant/requests.h"
#include "components/topics/node/tick_component.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::pneumatics {
namespace {

// Messages to and from the pressure managers of all joints.
class RobotPneumatics {
 public:
  RobotPneumatics(node::Node& node, node::TickLoop& loop, const PneumaticsConfig& config)
      : state_(loop.AddInput(node::kJointState)),
        actuator_(loop.AddInput(node::kActuatorState)),
        requests_(node, loop, config) {
    for (const ManagerConfig& joint : config.joints) managers_.emplace_back(joint);
  }

  void Step(const node::Tick& tick) {
    const types::Origin origin = state_.value().header.origin;
    if (requests_.Take(tick, origin, &managers_)) {
      for (PressureManager& manager : managers_) manager.Restart();
    }
    const msg::JointState& state = state_.value();
    const bool active = requests_.MayHold(state.robot_state);
    for (std::size_t j = 0; j < managers_.size(); ++j) {
      ManagerInput input;
      input.period_s = tick.period_s;
      input.active = active;
      input.reset = requests_.reset();
      // A manager that has just begun may not know yet that another one is obeyed.
      input.standby = requests_.standby() || !tick.settled;
      if (actuator_.fresh() && j < actuator_.value().joint_count) {
        const msg::ActuatorState& inside = actuator_.value();
        input.valid = inside.valid[j];
        input.chamber_bar = inside.chamber_pressure_bar[j];
        input.reservoir_bar = inside.reservoir_pressure_bar[j];
        input.valve_is_open = inside.valve_open[j];
      }
      output_[j] = managers_[j].Step(input);
    }
  }
  msg::ValveCommand Command() const {
    msg::ValveCommand message;
    message.joint_count = static_cast<std::uint8_t>(managers_.size());
    for (std::size_t j = 0; j < managers_.size(); ++j) {
      message.valve_open[j] = output_[j].valve_open;
      message.compressor_on[j] = output_[j].compressor_on;
      message.vent_open[j] = output_[j].vent_open;
    }
    return message;
  }
  msg::PneumaticState State(const node::Tick& tick) const {
    msg::PneumaticState message;
    message.state_tick = tick.tick;
    message.joint_count = static_cast<std::uint8_t>(managers_.size());
    for (std::size_t j = 0; j < managers_.size(); ++j) {
      const ManagerOutput& out = output_[j];
      message.mode[j] = out.mode;
      message.target_pressure_bar[j] = out.target_bar;
      message.pressure_bar[j] = out.pressure_bar;
      message.stiffness_Nm_rad[j] = out.stiffness_Nm_rad;
      message.settled[j] = out.settled;
      message.sensor_fault[j] = out.sensor_fault;
    }
    return message;
  }
  // The first trouble and its joint, one line; empty: none.
  std::string Trouble() const {
    for (std::size_t j = 0; j < managers_.size(); ++j) {
      if (output_[j].fault == Fault::kNone) continue;
      return "joint " + std::to_string(j) + ": " + FaultText(output_[j].fault);
    }
    return "";
  }
  void Exchange(types::StateArchive& archive) { archive(managers_, requests_); }

 private:
  std::vector<PressureManager> managers_;
  types::JointArray<ManagerOutput> output_{};
  node::TickInput<msg::JointState>& state_;
  node::TickInput<msg::ActuatorState>& actuator_;
  PressureRequests requests_;
};

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

#include "components/robot/pneumatics/participant/translate.h"

#include "components/base/types/robot_state.h"
#include "components/base/types/state_archive.h"

namespace sinew::pneumatics {

RobotPneumatics::RobotPneumatics(node::Node& node, node::TickLoop& loop,
                                 const PneumaticsConfig& config)
    : state_(loop.AddInput(node::kJointState)),
      actuator_(loop.AddInput(node::kActuatorState)),
      requests_(node, loop, config) {
  for (const ManagerConfig& joint : config.joints) managers_.emplace_back(joint);
}

void RobotPneumatics::Step(const node::Tick& tick) {
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

msg::ValveCommand RobotPneumatics::Command() const {
  msg::ValveCommand message;
  message.joint_count = static_cast<std::uint8_t>(managers_.size());
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    message.valve_open[j] = output_[j].valve_open;
    message.compressor_on[j] = output_[j].compressor_on;
    message.vent_open[j] = output_[j].vent_open;
  }
  return message;
}

msg::PneumaticState RobotPneumatics::State(const node::Tick& tick) const {
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

std::string RobotPneumatics::Trouble() const {
  for (std::size_t j = 0; j < managers_.size(); ++j) {
    if (output_[j].fault == Fault::kNone) continue;
    return "joint " + std::to_string(j) + ": " + FaultText(output_[j].fault);
  }
  return "";
}

void RobotPneumatics::Exchange(types::StateArchive& archive) { archive(managers_, requests_); }

}  // namespace sinew::pneumatics

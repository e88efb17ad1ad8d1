#include "bridge/virtual_axes/virtual_axes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "components/types/angle.h"
#include "components/types/control_mode.h"

namespace sinew::virtual_axes {
namespace {

using can::Command;
using can::Firmware;

constexpr std::int64_t kMs_ns = 1'000'000;
constexpr std::int64_t kLongestCatchUp_ns = 50 * kMs_ns;
constexpr std::int64_t kReboot_ns = 300 * kMs_ns;
constexpr double kOverspeedFactor = 1.2;             // vel_limit_tolerance of the firmware
constexpr std::uint32_t kControllerOverspeed = 0x1;  // bits of the controller error
constexpr std::uint32_t kControllerInvalidMode = 0x2;
constexpr int kMostBatches = 8;  // taken from a bus at once

// Order of Axis::due.
constexpr std::array<Command, 7> kCyclic = {Command::kHeartbeat,
                                            Command::kGetEncoderEstimates,
                                            Command::kGetIq,
                                            Command::kGetBusVoltageCurrent,
                                            Command::kGetMotorError,
                                            Command::kGetEncoderError,
                                            Command::kGetControllerError};

void Require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

double FiniteOrZero(double value) { return std::isfinite(value) ? value : 0.0; }

std::int32_t ToInt32(double value) {
  return static_cast<std::int32_t>(std::clamp(FiniteOrZero(value), -2147483648.0, 2147483647.0));
}

// Of a unit quaternion, body to world: about x, then y, then z of the world.
std::array<double, 3> RollPitchYaw(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)),
          std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

}  // namespace

void VirtualAxes::Check(const VirtualAxesConfig& config, int joints, int buses) {
  Require(config.step_s >= 1e-5 && config.step_s <= 0.1,
          "step_s = " + std::to_string(config.step_s) + ", expected 1e-5 to 0.1");
  Require(!config.axes.empty() || !config.nodes.empty(), "no axes and no sensor nodes");
  std::set<std::pair<int, int>> used;
  const auto check = [&](const std::string& what, int bus, int node, int joint, int direction) {
    Require(bus >= 0 && bus < buses, what + ": no bus " + std::to_string(bus));
    Require(node >= 0 && node <= can::kMaxNode,
            what + ": node " + std::to_string(node) + ", expected 0 to 63");
    Require(used.emplace(bus, node).second,
            what + ": node " + std::to_string(node) + " is used twice");
    Require(joint >= 0 && joint < joints, what + ": joint " + std::to_string(joint) +
                                              ", the plant has " + std::to_string(joints));
    Require(direction == 1 || direction == -1,
            what + ": direction " + std::to_string(direction) + ", expected 1 or -1");
  };
  for (const AxisConfig& a : config.axes) {
    check("axis", a.bus, a.node, a.joint, a.direction);
    Require(a.gear_ratio > 0.0 && a.torque_constant_Nm_A > 0.0 &&
                a.controller_torque_constant_Nm_A > 0.0 && a.velocity_limit_rev_s > 0.0 &&
                a.current_limit_A > 0.0 && a.encoder_counts_rev > 0.0 && a.watchdog_s >= 0.0 &&
                std::isfinite(a.zero_rev),
            "axis of node " + std::to_string(a.node) +
                ": ratios, constants and limits must be positive");
  }
  for (const SensorNodeConfig& n : config.nodes) {
    check("sensor node", n.bus, n.node, n.joint, n.direction);
  }
  std::set<std::pair<int, int>> behind;
  for (const GatewayConfig& g : config.gateways) {
    check("gateway", g.bus, g.node, 0, 1);
    const std::string who = "gateway of node " + std::to_string(g.node) + ": ";
    Require(!g.axes.empty() && g.axes.size() <= std::size_t{can::kCompactJoints},
            who + std::to_string(g.axes.size()) + " axes, expected 1 to " +
                std::to_string(can::kCompactJoints));
    for (const int node : g.axes) {
      Require(std::any_of(config.axes.begin(), config.axes.end(),
                          [&](const AxisConfig& a) { return a.bus == g.bus && a.node == node; }),
              who + "no axis of node " + std::to_string(node) + " on its bus");
      Require(behind.emplace(g.bus, node).second,
              who + "axis of node " + std::to_string(node) + " is behind a gateway already");
    }
  }
}

VirtualAxes::VirtualAxes(const VirtualAxesConfig& config, provider::Plant& plant,
                         std::vector<can::Transport*> transports)
    : config_(config), plant_(plant), transports_(std::move(transports)) {
  Check(config, plant.joint_count(), static_cast<int>(transports_.size()));
  for (const AxisConfig& a : config.axes) {
    Axis axis;
    axis.config = a;
    axis.velocity_limit_rev_s = a.velocity_limit_rev_s;
    axis.current_limit_A = a.current_limit_A;
    const AxisRates& r = a.rates;
    const std::array<int, 7> every = {r.heartbeat_ms,       r.encoder_ms,     r.iq_ms,
                                      r.bus_voltage_ms,     r.motor_error_ms, r.encoder_error_ms,
                                      r.controller_error_ms};
    for (std::size_t i = 0; i < every.size(); ++i) axis.due[i].every_ms = every[i];
    axes_.push_back(axis);
  }
  for (const SensorNodeConfig& n : config.nodes) {
    Node node;
    node.config = n;
    node.due[0].every_ms = n.heartbeat_ms;
    node.due[1].every_ms = n.encoder_ms;
    node.due[2].every_ms = n.sensors_ms;
    nodes_.push_back(node);
  }
  for (const GatewayConfig& g : config.gateways) {
    Gateway gateway;
    gateway.config = g;
    for (const int node : g.axes) {
      const auto axis = std::find_if(axes_.begin(), axes_.end(), [&](const Axis& a) {
        return a.config.bus == g.bus && a.config.node == node;
      });
      gateway.axes.push_back(static_cast<std::size_t>(axis - axes_.begin()));
    }
    gateways_.push_back(gateway);
  }
  step_ns_ = std::llround(1e9 * config.step_s);
  plant_.Reset(&sensors_);
}

void VirtualAxes::Start(std::int64_t now_ns) {
  next_step_ns_ = now_ns + step_ns_;
  // Nodes of a real bus are not in step with each other: spread their first messages over a period.
  std::int64_t spread_ns = 0;
  const auto begin = [&](auto& due) {
    for (Due& d : due) {
      if (d.every_ms > 0) d.at_ns = now_ns + spread_ns % (d.every_ms * kMs_ns);
    }
    spread_ns += 130'000;  // about a frame
  };
  for (Axis& axis : axes_) {
    axis.fed_ns = now_ns;
    begin(axis.due);
  }
  for (Node& node : nodes_) {
    node.started_ns = node.fed_ns = now_ns;
    begin(node.due);
  }
}

void VirtualAxes::Run(std::int64_t now_ns) {
  if (now_ns - next_step_ns_ > kLongestCatchUp_ns) next_step_ns_ = now_ns;
  Answer(now_ns);
  while (next_step_ns_ <= now_ns) {
    CheckWatchdogs(next_step_ns_);
    StepPlant();
    CheckSpeed();
    next_step_ns_ += step_ns_;
    ++steps_;
  }
  SendDue(now_ns);
}

void VirtualAxes::Answer(std::int64_t now_ns) {
  for (std::size_t bus = 0; bus < transports_.size(); ++bus) {
    std::array<can::Received, can::kFramesAtOnce> waiting;
    for (int batch = 0; batch < kMostBatches; ++batch) {
      const std::size_t count = transports_[bus]->TakeWaiting(waiting);
      for (std::size_t i = 0; i < count; ++i) {
        Take(static_cast<int>(bus), waiting[i].frame, now_ns);
      }
      if (count < waiting.size()) break;
    }
  }
}

void VirtualAxes::Take(int bus, const can::Frame& frame, std::int64_t now_ns) {
  const auto address = can::AddressOf(frame);
  if (!address) return;
  ++frames_taken_;
  for (Axis& axis : axes_) {
    if (axis.config.bus == bus && axis.config.node == address->node) {
      if (now_ns >= axis.silent_until_ns) TakeForAxis(axis, frame, now_ns);
      return;
    }
  }
  for (Node& node : nodes_) {
    if (node.config.bus != bus || node.config.node != address->node) continue;
    if (const auto valves = can::DecodeValveCommand(frame)) {
      node.valves = *valves;
      node.fed_ns = now_ns;
      node.watchdog_expired = false;
    }
    return;
  }
  for (Gateway& gateway : gateways_) {
    if (gateway.config.bus == bus && gateway.config.node == address->node) {
      TakeReferences(gateway, frame, now_ns);
      return;
    }
  }
}

void VirtualAxes::TakeReferences(Gateway& gateway, const can::Frame& frame, std::int64_t now_ns) {
  if (!can::DecodeReferences(gateway.config.node, frame, &gateway.references)) return;
  const int number = can::ReferenceFrameNumber(gateway.config.node, frame);
  constexpr std::size_t kFields = can::kCompactJoints / can::kCompactReferenceFrames;
  const std::size_t first = kFields * static_cast<std::size_t>(number);
  for (std::size_t i = first; i < std::min(first + kFields, gateway.axes.size()); ++i) {
    Axis& axis = axes_[gateway.axes[i]];
    if (now_ns < axis.silent_until_ns) continue;
    axis.fed_ns = now_ns;
    if (axis.mode != can::ControlMode::kPosition) continue;
    axis.input_position_rev = gateway.references.position_turns[i];
    axis.input_velocity_rev_s = axis.input_torque_Nm = 0.0;
  }
  if (number == can::kCompactReferenceFrames - 1) SendState(gateway, now_ns);
}

// An axis that is silent stands still in the state, as one whose last answer is kept.
void VirtualAxes::SendState(Gateway& gateway, std::int64_t now_ns) {
  can::CompactState& state = gateway.state;
  for (std::size_t i = 0; i < gateway.axes.size(); ++i) {
    const Axis& axis = axes_[gateway.axes[i]];
    if (axis.silenced || now_ns < axis.silent_until_ns) continue;
    state.position_turns[i] = PositionRev(axis);
    state.velocity_turns_s[i] = VelocityRevS(axis);
    state.iq_A[i] = IqA(axis);
  }
  if (const provider::BodySensors* body = plant_.body_sensors()) {
    state.force_N = body->foot_force_N;
    state.acceleration_m_s2 = body->acceleration_m_s2;
    state.angular_velocity_rad_s = body->angular_velocity_rad_s;
    state.roll_pitch_yaw_rad = RollPitchYaw(body->orientation_wxyz);
  }
  ++state.sequence;
  for (const can::Frame& sent : can::EncodeState(gateway.config.node, state)) {
    SendOn(gateway.config.bus, sent);
  }
}

void VirtualAxes::TakeForAxis(Axis& axis, const can::Frame& frame, std::int64_t now_ns) {
  const Firmware firmware = axis.config.firmware;
  const Command command = can::AddressOf(frame)->command;
  axis.fed_ns = now_ns;  // any frame feeds the watchdog, unknown ones too
  if (!can::Knows(firmware, command)) return;
  if (can::IsRequest(frame, firmware)) {
    SendAxis(axis, command);
    return;
  }
  switch (command) {
    case Command::kEstop:
      Fail(axis, can::axis_error::kEstopRequested);
      break;
    case Command::kSetAxisNodeId:
      if (const auto m = can::Decode<can::SetAxisNodeId>(frame, firmware);
          m && m->node <= can::kMaxNode) {
        axis.config.node = static_cast<int>(m->node);
      }
      break;
    case Command::kSetAxisState:
      if (const auto m = can::Decode<can::SetAxisState>(frame, firmware)) {
        switch (m->state) {
          case can::AxisState::kIdle:
            axis.state = can::AxisState::kIdle;
            break;
          case can::AxisState::kClosedLoopControl:
            if (axis.error == 0 && axis.state != can::AxisState::kClosedLoopControl) {
              // The firmware starts from where the motor is: no jump before the first setpoint.
              axis.input_position_rev = PositionRev(axis);
              axis.input_velocity_rev_s = 0.0;
              axis.input_torque_Nm = 0.0;
              axis.state = can::AxisState::kClosedLoopControl;
            }
            break;
          case can::AxisState::kStartupSequence:
          case can::AxisState::kFullCalibration:
          case can::AxisState::kMotorCalibration:
          case can::AxisState::kEncoderIndexSearch:
          case can::AxisState::kEncoderOffsetCalibration:
          case can::AxisState::kEncoderDirFind:
          case can::AxisState::kHoming:
          case can::AxisState::kHallPolarityCalibration:
          case can::AxisState::kHallPhaseCalibration:
            axis.state = can::AxisState::kIdle;
            break;
          default:
            Fail(axis, can::axis_error::kInvalidState);
            break;
        }
      }
      break;
    case Command::kSetControllerMode:
      if (const auto m = can::Decode<can::SetControllerMode>(frame, firmware)) {
        const auto mode = static_cast<int>(m->control_mode);
        if (mode < 1 || mode > 3) {  // voltage control is not for this plant
          axis.controller_error |= kControllerInvalidMode;
          Fail(axis, can::axis_error::kControllerFailed);
        } else {
          axis.mode = m->control_mode;
        }
      }
      break;
    case Command::kSetInputPos:
      if (const auto m = can::Decode<can::SetInputPos>(frame, firmware)) {
        axis.input_position_rev = m->position_rev;
        axis.input_velocity_rev_s = m->velocity_feed_forward_rev_s;
        axis.input_torque_Nm = m->torque_feed_forward_Nm;
      }
      break;
    case Command::kSetInputVel:
      if (const auto m = can::Decode<can::SetInputVel>(frame, firmware)) {
        axis.input_velocity_rev_s = m->velocity_rev_s;
        axis.input_torque_Nm = m->torque_feed_forward_Nm;
      }
      break;
    case Command::kSetInputTorque:
      if (const auto m = can::Decode<can::SetInputTorque>(frame, firmware))
        axis.input_torque_Nm = m->torque_Nm;
      break;
    case Command::kSetLimits:
      if (const auto m = can::Decode<can::SetLimits>(frame, firmware)) {
        if (std::isfinite(m->velocity_limit_rev_s))
          axis.velocity_limit_rev_s = std::abs(m->velocity_limit_rev_s);
        if (firmware != Firmware::k0_5_1 && std::isfinite(m->current_limit_A)) {
          axis.current_limit_A = std::abs(m->current_limit_A);
        }
      }
      break;
    case Command::kReboot:
      axis.state = can::AxisState::kIdle;
      axis.error = axis.encoder_error = axis.controller_error = 0;
      axis.motor_error = 0;
      axis.velocity_limit_rev_s = axis.config.velocity_limit_rev_s;
      axis.current_limit_A = axis.config.current_limit_A;
      axis.silent_until_ns = now_ns + kReboot_ns;
      axis.fed_ns = axis.silent_until_ns;
      break;
    case Command::kClearErrors:
      axis.error = axis.encoder_error = axis.controller_error = 0;
      axis.motor_error = 0;
      break;
    case Command::kGetAdcVoltage:
      if (can::Decode<can::AdcRequest>(frame, firmware)) SendAxis(axis, command);
      break;
    default:
      break;  // gains, trajectories, anticogging: taken note of by nobody
  }
}

void VirtualAxes::SendDue(std::int64_t now_ns) {
  const auto is_due = [now_ns](Due& due) {
    if (due.every_ms <= 0 || now_ns < due.at_ns) return false;
    due.at_ns += due.every_ms * kMs_ns;
    if (due.at_ns <= now_ns) due.at_ns = now_ns + due.every_ms * kMs_ns;  // late: no burst
    return true;
  };
  for (Axis& axis : axes_) {
    for (std::size_t i = 0; i < axis.due.size(); ++i) {
      if (is_due(axis.due[i]) && now_ns >= axis.silent_until_ns) SendAxis(axis, kCyclic[i]);
    }
  }
  for (Node& node : nodes_) {
    for (std::size_t i = 0; i < node.due.size(); ++i) {
      if (is_due(node.due[i])) SendNode(node, static_cast<int>(i), now_ns);
    }
  }
}

void VirtualAxes::SendAxis(Axis& axis, Command command) {
  if (axis.silenced || !can::Knows(axis.config.firmware, command)) return;
  const Firmware firmware = axis.config.firmware;
  const int node = axis.config.node;
  const auto send = [&](const auto& message) {
    SendOn(axis.config.bus, can::Encode(node, message, firmware));
  };
  const double counts = PositionRev(axis) * axis.config.encoder_counts_rev;
  switch (command) {
    case Command::kHeartbeat:
      send(can::Heartbeat{axis.error, axis.state, axis.motor_error != 0, axis.encoder_error != 0,
                          axis.controller_error != 0, false});
      break;
    case Command::kGetMotorError:
      send(can::MotorError{axis.motor_error});
      break;
    case Command::kGetEncoderError:
      send(can::EncoderError{axis.encoder_error});
      break;
    case Command::kGetControllerError:
      send(can::ControllerError{axis.controller_error});
      break;
    case Command::kGetSensorlessError:
      send(can::SensorlessError{});
      break;
    case Command::kGetEncoderEstimates:
      send(can::EncoderEstimates{PositionRev(axis), VelocityRevS(axis)});
      break;
    case Command::kGetSensorlessEstimates:
      send(can::SensorlessEstimates{PositionRev(axis), VelocityRevS(axis)});
      break;
    case Command::kGetEncoderCount: {
      const double within = counts - axis.config.encoder_counts_rev *
                                         std::floor(counts / axis.config.encoder_counts_rev);
      send(can::EncoderCount{ToInt32(std::floor(counts)), ToInt32(within)});
      break;
    }
    case Command::kGetIq:
      // 0.5.4 sends its two setpoints, Id and Iq, in place of setpoint and measurement.
      if (firmware == Firmware::k0_5_4) {
        send(can::Iq{0.0, axis.iq_setpoint_A});
      } else {
        send(can::Iq{axis.iq_setpoint_A, IqA(axis)});
      }
      break;
    case Command::kGetBusVoltageCurrent: {
      const double power_W =
          IqA(axis) * axis.config.torque_constant_Nm_A * types::kTwoPi * VelocityRevS(axis);
      send(can::BusVoltageCurrent{axis.config.bus_voltage_V, power_W / axis.config.bus_voltage_V});
      break;
    }
    case Command::kGetAdcVoltage:
      send(can::AdcVoltage{0.0});
      break;
    default:
      break;
  }
}

void VirtualAxes::SendNode(Node& node, int which, std::int64_t now_ns) {
  const auto j = static_cast<std::size_t>(node.config.joint);
  can::Frame frame;
  if (which == 0) {
    frame = can::Encode(
        node.config.node,
        can::NodeHeartbeat{static_cast<std::uint32_t>((now_ns - node.started_ns) / kMs_ns), 0, 1});
  } else if (which == 1) {
    can::OutputEncoder m;
    m.angle_rad = node.config.direction * sensors_.position_rad[j] + node.config.zero_rad;
    m.velocity_rad_s = node.config.direction * sensors_.velocity_rad_s[j];
    m.sequence = node.sequence++;
    m.encoder_valid = m.pressure_valid = m.load_valid = sensors_.valid[j];
    m.valve_open = sensors_.valve_open[j];
    m.compressor_on = command_.compressor_on[j];
    m.vent_open = command_.vent_open[j];
    m.watchdog_expired = node.watchdog_expired;
    frame = can::Encode(node.config.node, m);
  } else {
    frame = can::Encode(
        node.config.node,
        can::JointSensors{sensors_.chamber_pressure_bar[j], sensors_.reservoir_pressure_bar[j],
                          sensors_.load_force_N[j], sensors_.motor_temperature_degC[j]});
  }
  SendOn(node.config.bus, frame);
}

void VirtualAxes::CheckWatchdogs(std::int64_t now_ns) {
  for (Axis& axis : axes_) {
    if (axis.config.watchdog_s <= 0.0 || now_ns < axis.silent_until_ns) continue;
    if (static_cast<double>(now_ns - axis.fed_ns) > 1e9 * axis.config.watchdog_s) {
      Fail(axis, can::axis_error::kWatchdogTimerExpired);
    }
  }
  for (Node& node : nodes_) {
    if (node.valves.timeout_ms > 0 && now_ns - node.fed_ns > node.valves.timeout_ms * kMs_ns) {
      node.watchdog_expired = true;
      node.valves = can::ValveCommand{};
    }
  }
}

void VirtualAxes::CheckSpeed() {
  for (Axis& axis : axes_) {
    if (axis.state != can::AxisState::kClosedLoopControl) continue;
    if (std::abs(VelocityRevS(axis)) > kOverspeedFactor * axis.velocity_limit_rev_s) {
      axis.controller_error |= kControllerOverspeed;
      Fail(axis, can::axis_error::kControllerFailed);
    }
  }
}

void VirtualAxes::Fail(Axis& axis, std::uint32_t error) {
  axis.error |= error;
  axis.state = can::AxisState::kIdle;
}

void VirtualAxes::StepPlant() {
  for (Axis& axis : axes_) {
    const AxisConfig& c = axis.config;
    const auto j = static_cast<std::size_t>(c.joint);
    command_.mode[j] = types::ControlMode::kIdle;
    command_.motor_torque_Nm[j] = 0.0;
    axis.iq_setpoint_A = 0.0;
    if (axis.state != can::AxisState::kClosedLoopControl) continue;
    const double output_rad_per_rev = c.direction * types::kTwoPi / c.gear_ratio;
    const double limit_rev_s = axis.velocity_limit_rev_s;
    const double velocity_rev_s =
        std::clamp(FiniteOrZero(axis.input_velocity_rev_s), -limit_rev_s, limit_rev_s);
    command_.velocity_rad_s[j] = velocity_rev_s * output_rad_per_rev;
    switch (axis.mode) {
      case can::ControlMode::kTorque: {
        command_.mode[j] = types::ControlMode::kTorque;
        const double current_A =
            std::clamp(FiniteOrZero(axis.input_torque_Nm) / c.controller_torque_constant_Nm_A,
                       -axis.current_limit_A, axis.current_limit_A);
        axis.iq_setpoint_A = current_A;
        command_.motor_torque_Nm[j] = c.direction * current_A * c.torque_constant_Nm_A;
        break;
      }
      case can::ControlMode::kPosition:
        command_.mode[j] = types::ControlMode::kPosition;
        if (std::isfinite(axis.input_position_rev)) {
          command_.position_rad[j] = (axis.input_position_rev - c.zero_rev) * output_rad_per_rev;
        }
        break;
      case can::ControlMode::kVelocity:
        command_.mode[j] = types::ControlMode::kVelocity;
        break;
      case can::ControlMode::kVoltage:
        break;
    }
    if (axis.mode != can::ControlMode::kTorque) axis.iq_setpoint_A = IqA(axis);
  }
  for (const Node& node : nodes_) {
    const auto j = static_cast<std::size_t>(node.config.joint);
    command_.valve_open[j] = node.valves.valve_open;
    command_.compressor_on[j] = node.valves.compressor_on;
    command_.vent_open[j] = node.valves.vent_open;
  }
  plant_.Step(command_, config_.step_s, &sensors_);
}

double VirtualAxes::PositionRev(const Axis& axis) const {
  const auto j = static_cast<std::size_t>(axis.config.joint);
  return axis.config.direction * sensors_.motor_position_rad[j] / types::kTwoPi +
         axis.config.zero_rev;
}

double VirtualAxes::VelocityRevS(const Axis& axis) const {
  const auto j = static_cast<std::size_t>(axis.config.joint);
  return axis.config.direction * sensors_.motor_velocity_rad_s[j] / types::kTwoPi;
}

double VirtualAxes::IqA(const Axis& axis) const {
  return axis.config.direction *
         sensors_.motor_current_A[static_cast<std::size_t>(axis.config.joint)];
}

void VirtualAxes::SendOn(int bus, const can::Frame& frame) {
  (void)transports_[static_cast<std::size_t>(bus)]->Send(
      frame);  // counted there; the next one is under way
}

void VirtualAxes::SetAxisError(int axis, std::uint32_t error) {
  Fail(axes_.at(static_cast<std::size_t>(axis)), error);
}
void VirtualAxes::Silence(int axis, bool silent) {
  axes_.at(static_cast<std::size_t>(axis)).silenced = silent;
}
can::AxisState VirtualAxes::axis_state(int axis) const {
  return axes_.at(static_cast<std::size_t>(axis)).state;
}
std::uint32_t VirtualAxes::axis_error(int axis) const {
  return axes_.at(static_cast<std::size_t>(axis)).error;
}
double VirtualAxes::input_torque_Nm(int axis) const {
  return axes_.at(static_cast<std::size_t>(axis)).input_torque_Nm;
}
void VirtualAxes::SetHand(int joint, double force_N) {
  command_.hand_force_N.at(static_cast<std::size_t>(joint)) =
      std::isfinite(force_N) ? force_N : 0.0;
}

bool VirtualAxes::valve_open(int node) const {
  return nodes_.at(static_cast<std::size_t>(node)).valves.valve_open;
}

}  // namespace sinew::virtual_axes

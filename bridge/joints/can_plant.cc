#include "bridge/joints/can_plant.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <stdexcept>
#include <utility>

#include "components/types/angle.h"
#include "components/types/control_mode.h"
#include "components/types/joints.h"
#include "components/types/signal.h"

namespace sinew::bridge {
namespace {

using can::Command;
using types::ControlMode;

constexpr double kTurn_rad = types::kTwoPi;
constexpr std::int64_t kTellAgain_ns =
    100'000'000;                                  // a state that was not taken is asked for again
constexpr std::int64_t kClearing_ns = 5'000'000;  // until Clear_Errors has been taken
constexpr double kTaper = 0.1;                    // of the velocity limit
constexpr double kOverspeed = 1.5;                // of the velocity limit
constexpr double kJump_rev = 0.25;
constexpr double kWaited_s = 0.01;  // of a measurement for its frame
constexpr const char* kBeyondCompact = "its position is beyond what the compact exchange tells";
constexpr int kMostBatches = 64;          // taken from a bus at once
constexpr std::size_t kMostFrames = 256;  // of a cycle, without allocating

constexpr std::array kAxisCommands = {Command::kHeartbeat,       Command::kGetMotorError,
                                      Command::kGetEncoderError, Command::kGetEncoderEstimates,
                                      Command::kGetIq,           Command::kGetControllerError};
constexpr std::array kNodeCommands = {can::NodeCommand::kHeartbeat,
                                      can::NodeCommand::kOutputEncoder,
                                      can::NodeCommand::kJointSensors};

std::int64_t Ns(double seconds) { return static_cast<std::int64_t>(std::llround(1e9 * seconds)); }

std::string AxisErrorText(std::uint32_t error) {
  static constexpr struct {
    std::uint32_t bit;
    const char* name;
  } kNames[] = {
      {can::axis_error::kInvalidState, "invalid state"},
      {can::axis_error::kMotorFailed, "motor failed"},
      {can::axis_error::kEncoderFailed, "encoder failed"},
      {can::axis_error::kControllerFailed, "controller failed"},
      {can::axis_error::kWatchdogTimerExpired, "watchdog expired"},
      {can::axis_error::kMinEndstopPressed, "minimum end stop"},
      {can::axis_error::kMaxEndstopPressed, "maximum end stop"},
      {can::axis_error::kEstopRequested, "estop requested"},
      {can::axis_error::kOverTemp, "over-temperature"},
      {can::axis_error::kUnknownPosition, "unknown position"},
  };
  char text[32];
  std::snprintf(text, sizeof text, "axis error 0x%X", error);
  std::string result = text;
  for (const auto& [bit, name] : kNames) {
    if ((error & bit) != 0) result += std::string(", ") + name;
  }
  return result;
}

void Require(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

can::ControlMode ToControlMode(ControlMode mode) {
  switch (mode) {
    case ControlMode::kPosition:
      return can::ControlMode::kPosition;
    case ControlMode::kVelocity:
      return can::ControlMode::kVelocity;
    case ControlMode::kTorque:
    case ControlMode::kIdle:
      break;
  }
  return can::ControlMode::kTorque;
}

}  // namespace

double CanPlant::Joint::motor_position_rad() const {
  return config.direction * kTurn_rad * (estimates.position_rev - config.zero_rev - home_rev);
}
double CanPlant::Joint::motor_velocity_rad_s() const {
  return config.direction * kTurn_rad * estimates.velocity_rev_s;
}
double CanPlant::Joint::position_rad() const {
  if (config.output) return config.output->direction * (output.angle_rad - config.output->zero_rad);
  return motor_position_rad() / config.gear_ratio;
}
double CanPlant::Joint::velocity_rad_s() const {
  if (config.output) return config.output->direction * output.velocity_rad_s;
  return motor_velocity_rad_s() / config.gear_ratio;
}

void CanPlant::Check(const BridgeConfig& config) {
  const auto buses = static_cast<int>(config.bitrate_bit_s.size());
  Require(buses >= 1 && buses <= provider::BusReport::kMaxBuses,
          std::to_string(buses) + " buses, expected 1 to " +
              std::to_string(provider::BusReport::kMaxBuses));
  Require(
      !config.joints.empty() && config.joints.size() <= static_cast<std::size_t>(types::kMaxJoints),
      std::to_string(config.joints.size()) + " joints, expected 1 to " +
          std::to_string(types::kMaxJoints));
  std::set<std::pair<int, int>> used;
  std::string who;
  const auto claim = [&](int bus, int node) {
    Require(bus >= 0 && bus < buses, who + "no bus " + std::to_string(bus));
    Require(node >= 0 && node <= can::kMaxNode,
            who + "node " + std::to_string(node) + ", expected 0 to 63");
    Require(used.emplace(bus, node).second,
            who + "node " + std::to_string(node) + " is used twice");
  };
  for (const JointConfig& c : config.joints) {
    who = "joint '" + c.name + "': ";
    claim(c.bus, c.node);
    if (c.output) claim(c.bus, c.output->node);
    const auto unit = [](int direction) { return direction == 1 || direction == -1; };
    Require(unit(c.direction) && (!c.output || unit(c.output->direction)),
            who + "direction must be 1 or -1");
    Require(c.gear_ratio > 0.0 && c.torque_constant_Nm_A > 0.0 &&
                c.controller_torque_constant_Nm_A > 0.0,
            who + "gear ratio and torque constants must be positive");
    Require(c.torque_efficiency > 0.0 && c.torque_efficiency <= 1.0,
            who + "torque_efficiency must be above 0, at most 1");
    Require(
        c.limits.motor_torque_Nm > 0.0 && c.limits.current_A > 0.0 && c.limits.velocity_rad_s > 0.0,
        who + "limits of torque, current and velocity must be positive");
    if (c.home_by_whole_turns) Require(c.zero_check.has_value(), who + "homing needs a zero_check");
    if (c.zero_check) {
      Require(c.output.has_value(), who + "zero_check needs a sensor node");
      Require(c.zero_check->play_rad >= 0.0 && c.zero_check->tolerance_rad > 0.0,
              who + "zero_check needs play_rad >= 0 and tolerance_rad > 0");
      const double most_rev =
          (0.5 * c.zero_check->play_rad + c.zero_check->tolerance_rad) * c.gear_ratio / kTurn_rad;
      char text[96];
      std::snprintf(text, sizeof text,
                    "whole turns cannot be told: play and tolerance are %.2f of a "
                    "motor turn, expected below 0.5",
                    most_rev);
      Require(!c.home_by_whole_turns || most_rev < 0.5, who + text);
    }
    Require(
        c.limits.lower_rad < c.limits.upper_rad && c.limits.margin_rad >= 0.0,
        who + "position limits must have lower_rad < upper_rad and a margin that is not negative");
  }
  std::set<int> behind;
  for (const GatewayConfig& g : config.gateways) {
    who = "gateway of node " + std::to_string(g.node) + ": ";
    claim(g.bus, g.node);
    Require(!g.joints.empty() && g.joints.size() <= std::size_t{can::kCompactJoints},
            who + std::to_string(g.joints.size()) + " joints, expected 1 to " +
                std::to_string(can::kCompactJoints));
    for (const int j : g.joints) {
      Require(j >= 0 && static_cast<std::size_t>(j) < config.joints.size(),
              who + "no joint " + std::to_string(j));
      const JointConfig& c = config.joints[static_cast<std::size_t>(j)];
      Require(c.bus == g.bus, who + "joint '" + c.name + "' is on another bus");
      Require(behind.insert(j).second, who + "joint '" + c.name + "' is behind a gateway already");
    }
  }
}

CanPlant::CanPlant(const BridgeConfig& config, std::vector<can::Transport*> transports)
    : config_(config), transports_(std::move(transports)) {
  Check(config);
  Require(config.bitrate_bit_s.size() == transports_.size(), "a bit rate for each bus is expected");
  std::array<int, 64> none;
  none.fill(-1);
  axis_of_.assign(transports_.size(), none);
  node_of_.assign(transports_.size(), none);
  gateway_of_.assign(transports_.size(), none);
  outbox_.resize(transports_.size());
  for (auto& frames : outbox_) frames.reserve(kMostFrames);
  std::vector<int> on_bus(transports_.size(), 0);
  for (const JointConfig& c : config.joints) {
    const auto b = static_cast<std::size_t>(c.bus);
    const int index = static_cast<int>(joints_.size());
    axis_of_[b][static_cast<std::size_t>(c.node)] = index;
    if (c.output) node_of_[b][static_cast<std::size_t>(c.output->node)] = index;
    joints_.emplace_back().config = c;
    joints_.back().turn = on_bus[b]++;
  }
  for (const GatewayConfig& g : config.gateways) {
    const int index = static_cast<int>(links_.size());
    gateway_of_[static_cast<std::size_t>(g.bus)][static_cast<std::size_t>(g.node)] = index;
    links_.emplace_back(g.node);
    for (std::size_t field = 0; field < g.joints.size(); ++field) {
      Joint& joint = joints_[static_cast<std::size_t>(g.joints[field])];
      joint.gateway = index;
      joint.field = static_cast<int>(field);
    }
  }
  report_.bus_count = static_cast<int>(transports_.size());
  answers_.resize(transports_.size());
  references_ns_.assign(links_.size(), 0);
}

std::vector<can::IdFilter> CanPlant::Filters(const BridgeConfig& config, int bus) {
  std::vector<can::IdFilter> filters;
  for (const JointConfig& joint : config.joints) {
    if (joint.bus != bus) continue;
    for (const Command command : kAxisCommands) {
      filters.push_back({can::Identifier(joint.node, command), can::kMaxStandardId, false});
    }
    if (!joint.output) continue;
    for (const can::NodeCommand command : kNodeCommands) {
      filters.push_back({can::Identifier(joint.output->node, command), can::kMaxStandardId, false});
    }
  }
  for (const GatewayConfig& gateway : config.gateways) {
    if (gateway.bus != bus) continue;
    for (int k = 0; k < can::kCompactStateFrames; ++k) {
      filters.push_back(
          {can::Identifier(gateway.node, can::StateCommand(k)), can::kMaxStandardId, false});
    }
  }
  return filters;
}

std::uint32_t CanPlant::measured_flags() const {
  const bool all_outputs = std::all_of(joints_.begin(), joints_.end(),
                                       [](const Joint& j) { return j.config.output.has_value(); });
  return types::kMotorSignals | types::SignalBit(types::Signal::kPayload) |
         (all_outputs ? types::kOutputSignals : 0u);
}

void CanPlant::Reset(provider::PlantSensors* sensors) {
  *sensors = provider::PlantSensors{};
  can::Transport& clock = *transports_.front();
  const std::int64_t give_up_ns = clock.now_ns() + Ns(config_.timing.start_timeout_s);
  std::int64_t next_request_ns = 0;
  Drain();  // what waited in the sockets since they were opened is old
  for (Joint& joint : joints_) {
    Joint fresh;
    fresh.config = std::move(joint.config);
    fresh.turn = joint.turn;
    fresh.gateway = joint.gateway;
    fresh.field = joint.field;
    joint = std::move(fresh);
    Send(joint, can::SetAxisState{can::AxisState::kIdle});
    Send(joint, can::ClearErrors{});
  }
  Flush();
  const auto missing = [](const Joint& joint) -> std::string {
    const std::string axis = "axis node " + std::to_string(joint.config.node);
    if (joint.heartbeat_ns == 0) return "no heartbeat of " + axis;
    if (joint.estimates_ns == 0) return "no encoder estimates of " + axis;
    if (joint.config.output && (joint.output_ns == 0 || joint.sensors_ns == 0)) {
      return "nothing from sensor node " + std::to_string(joint.config.output->node);
    }
    return {};
  };
  for (;;) {
    Drain();
    const auto silent = std::find_if(joints_.begin(), joints_.end(),
                                     [&](const Joint& j) { return !missing(j).empty(); });
    if (silent == joints_.end()) break;
    const std::int64_t now_ns = clock.now_ns();
    if (now_ns >= give_up_ns) {
      const auto bus = static_cast<std::size_t>(silent->config.bus);
      char text[160];
      std::snprintf(text, sizeof text,
                    " within %.1f s; is it powered, on bus '%s' (%s), at %.0f bit/s?",
                    config_.timing.start_timeout_s, transports_[bus]->name().c_str(),
                    can::LinkName(transports_[bus]->link()), config_.bitrate_bit_s[bus]);
      throw std::runtime_error("joint '" + silent->config.name + "': " + missing(*silent) + text);
    }
    if (now_ns >= next_request_ns) {
      next_request_ns = now_ns + 20'000'000;
      for (Joint& joint : joints_) {
        SendNeutral(joint);  // feeds watchdogs
        if (joint.gateway < 0) Ask(joint, Command::kGetEncoderEstimates);
      }
      PostReferences();
      Flush();
    }
    can::Received received;
    if (clock.Receive(std::chrono::milliseconds(2), &received)) Take(0, received);
  }
  ClearFault();
  const std::int64_t now_ns = clock.now_ns();
  for (Joint& joint : joints_) {
    joint.iq_ns = now_ns;
    CheckZero(joint);
  }
  Fill(now_ns, sensors);
  report_ns_ = now_ns;
}

void CanPlant::ClearFault() {
  const std::int64_t now_ns = transports_.front()->now_ns();
  const std::int64_t cleared_ns = now_ns + kClearing_ns;
  for (Joint& joint : joints_) {
    if (joint.fault_told) {
      joint.fault = FaultKind::kNone;
      joint.fault_text.clear();
      if (joint.phase != Phase::kIdle) {  // it goes on only after arming
        joint.phase = Phase::kIdle;
        joint.phase_ns = now_ns;
        SendIdle(joint, now_ns);
      }
    }
    joint.asked_errors = false;
    joint.answered = 0;
    joint.heartbeat.axis_error = 0;  // until a later heartbeat says otherwise
    joint.cleared_ns = cleared_ns;
    Send(joint, can::ClearErrors{});
    Home(joint);
  }
  Flush();
}

void CanPlant::Rest() {
  const std::int64_t now_ns = transports_.front()->now_ns();
  for (Joint& joint : joints_) {
    joint.phase = Phase::kIdle;
    joint.phase_ns = now_ns;
    SendNeutral(joint);
    SendIdle(joint, now_ns);
    if (joint.config.output) {
      can::ValveCommand off;
      off.sequence = joint.valve_sequence++;
      off.timeout_ms = static_cast<std::uint16_t>(config_.timing.valve_timeout_ms);
      Post(joint.config.bus, can::Encode(joint.config.output->node, off));
    }
  }
  PostReferences();
  Flush();
}

void CanPlant::Act(const provider::PlantCommand& command, double period_s) {
  acted_ = true;
  const std::int64_t start_ns = transports_.front()->now_ns();
  Drain();  // what came in since: phases and limits assess by the newest
  Assess(transports_.front()->now_ns());  // no setpoint for an axis that has just told an error
  // Cyclic estimates: the answer is there by the end of the cycle. Requested ones: Step asks.
  const bool cyclic = config_.timing.estimates == Estimates::kCyclic;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    ControlMode mode = command.mode[j];
    if (mode != ControlMode::kIdle &&
        !(std::isfinite(command.motor_torque_Nm[j]) && std::isfinite(command.position_rad[j]) &&
          std::isfinite(command.velocity_rad_s[j]))) {
      Fail(joint, FaultKind::kNotFinite, "a command that is not finite");
    }
    if (joint.fault != FaultKind::kNone) mode = ControlMode::kIdle;
    CommandJoint(joint, mode, command.motor_torque_Nm[j], command.position_rad[j],
                 command.velocity_rad_s[j], period_s, start_ns);
    if (cyclic && AsksIq(joint)) Ask(joint, Command::kGetIq);
    if (joint.config.output) {
      Post(joint.config.bus,
           can::Encode(
               joint.config.output->node,
               can::ValveCommand{command.valve_open[j], command.compressor_on[j],
                                 command.vent_open[j], joint.valve_sequence++,
                                 static_cast<std::uint16_t>(config_.timing.valve_timeout_ms)}));
    }
  }
  PostReferences();
  Flush();
  acted_us_ = 1e-3 * static_cast<double>(transports_.front()->now_ns() - start_ns);
}

void CanPlant::Step(const provider::PlantCommand& command, double period_s,
                    provider::PlantSensors* sensors) {
  can::Transport& clock = *transports_.front();
  if (!acted_) Act(command, period_s);
  acted_ = false;
  if (config_.timing.estimates == Estimates::kRequested) {
    const std::int64_t asked_ns = clock.now_ns();
    for (Joint& joint : joints_) {
      if (joint.gateway < 0) Ask(joint, Command::kGetEncoderEstimates);
      if (AsksIq(joint)) Ask(joint, Command::kGetIq);
    }
    Flush();
    Collect(asked_ns);
  }
  const std::int64_t start_ns = clock.now_ns();
  Drain();
  Assess(clock.now_ns());
  Flush();
  Fill(clock.now_ns(), sensors);
  ++cycle_;
  const std::int64_t end_ns = clock.now_ns();
  Report(end_ns, acted_us_ + 1e-3 * static_cast<double>(end_ns - start_ns));
}

// In turn: the answers of all in one cycle would be more than its share of the bus.
bool CanPlant::AsksIq(const Joint& joint) const {
  const auto every = static_cast<std::uint64_t>(config_.timing.iq_every_cycles);
  return joint.gateway < 0 && every > 0 &&
         (cycle_ + static_cast<std::uint64_t>(joint.turn)) % every == 0;
}

void CanPlant::Ask(Joint& joint, Command command) {
  if (command == Command::kGetIq) joint.iq_asked_ns = transports_.front()->now_ns();
  if (command == Command::kGetEncoderEstimates) {
    joint.estimates_asked_ns = transports_.front()->now_ns();
  }
  Post(joint.config.bus, can::EncodeRequest(joint.config.node, command));
}

void CanPlant::PostReferences() {
  for (std::size_t g = 0; g < links_.size(); ++g) {
    for (const can::Frame& frame : links_[g].References()) Post(config_.gateways[g].bus, frame);
    references_ns_[g] = transports_.front()->now_ns();
  }
}

// Frames that find no room are counted by the transport; the next cycle's are newer.
void CanPlant::Flush() {
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    if (!outbox_[b].empty()) transports_[b]->SendAll(outbox_[b]);
    outbox_[b].clear();
  }
}

void CanPlant::Drain() {
  std::array<can::Received, can::kFramesAtOnce> waiting;
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    // Bounded: a flooded bus must not keep the cycle.
    for (int i = 0; i < kMostBatches; ++i) {
      const std::size_t count = transports_[b]->TakeWaiting(waiting);
      for (std::size_t k = 0; k < count; ++k) Take(static_cast<int>(b), waiting[k]);
      if (count < waiting.size()) break;
    }
  }
}

void CanPlant::Answered(int bus, std::int64_t* asked_ns, std::int64_t stamp_ns) {
  if (*asked_ns == 0 || stamp_ns < *asked_ns) return;
  answers_[static_cast<std::size_t>(bus)].Add(1e-3 * static_cast<double>(stamp_ns - *asked_ns));
  *asked_ns = 0;
}

bool CanPlant::AllAnswered(std::int64_t cycle_start_ns) const {
  return std::all_of(joints_.begin(), joints_.end(), [&](const Joint& j) {
    return j.gateway >= 0 ||
           (j.estimates_ns >= cycle_start_ns && (!AsksIq(j) || j.iq_ns >= cycle_start_ns));
  });
}

void CanPlant::Collect(std::int64_t cycle_start_ns) {
  can::Transport& clock = *transports_.front();
  const std::int64_t give_up_ns = cycle_start_ns + Ns(config_.timing.answer_window_s);
  can::Received received;
  for (;;) {
    Drain();
    const std::int64_t left_ns = give_up_ns - clock.now_ns();
    if (left_ns <= 0 || AllAnswered(cycle_start_ns)) return;
    if (transports_.size() == 1 || clock.descriptor() < 0) {
      if (clock.Receive(std::chrono::nanoseconds(left_ns), &received)) Take(0, received);
    } else {
      can::WaitForAny(transports_, std::chrono::nanoseconds(left_ns));
    }
  }
}

void CanPlant::Take(int bus, const can::Received& received) {
  const auto address = can::AddressOf(received.frame);
  if (!address || received.frame.remote) return;
  const auto b = static_cast<std::size_t>(bus);
  const auto n = static_cast<std::size_t>(address->node);
  if (const int axis = axis_of_[b][n]; axis >= 0) {
    TakeFromAxis(joints_[static_cast<std::size_t>(axis)], received);
  } else if (const int node = node_of_[b][n]; node >= 0) {
    TakeFromNode(joints_[static_cast<std::size_t>(node)], received);
  } else if (const int gateway = gateway_of_[b][n]; gateway >= 0) {
    TakeFromGateway(static_cast<std::size_t>(gateway), received);
  }
}

void CanPlant::TakeFromAxis(Joint& joint, const can::Received& received) {
  const can::Frame& frame = received.frame;
  const can::Firmware firmware = joint.config.firmware;
  switch (can::AddressOf(frame)->command) {
    case Command::kHeartbeat:
      if (const auto m = can::Decode<can::Heartbeat>(frame, firmware)) {
        joint.heartbeat = *m;
        joint.heartbeat_ns = received.stamp_ns;
        // Sent before the controller took our Clear_Errors: its errors are those just cleared.
        if (received.stamp_ns <= joint.cleared_ns) joint.heartbeat.axis_error = 0;
        return;
      }
      break;
    case Command::kGetEncoderEstimates:
      if (const auto m = can::Decode<can::EncoderEstimates>(frame, firmware);
          m && std::isfinite(m->position_rev) && std::isfinite(m->velocity_rev_s)) {
        TakeEstimates(joint, *m, received.stamp_ns);
        Answered(joint.config.bus, &joint.estimates_asked_ns, received.stamp_ns);
        return;
      }
      break;
    case Command::kGetIq:
      if (const auto m = can::Decode<can::Iq>(frame, firmware); m && std::isfinite(m->measured_A)) {
        joint.iq_A = m->measured_A;
        joint.iq_ns = received.stamp_ns;
        Answered(joint.config.bus, &joint.iq_asked_ns, received.stamp_ns);
        return;
      }
      break;
    case Command::kGetMotorError:
      if (const auto m = can::Decode<can::MotorError>(frame, firmware)) {
        AppendError(joint, Command::kGetMotorError, "motor", m->error);
        return;
      }
      break;
    case Command::kGetEncoderError:
      if (const auto m = can::Decode<can::EncoderError>(frame, firmware)) {
        AppendError(joint, Command::kGetEncoderError, "encoder", m->error);
        return;
      }
      break;
    case Command::kGetControllerError:
      if (const auto m = can::Decode<can::ControllerError>(frame, firmware)) {
        AppendError(joint, Command::kGetControllerError, "controller", m->error);
        return;
      }
      break;
    default:
      return;  // not one we use
  }
  ++malformed_;
}

void CanPlant::TakeEstimates(Joint& joint, const can::EncoderEstimates& estimates,
                             std::int64_t stamp_ns) {
  if (joint.estimates_ns != 0) {
    const double dt_s =
        1e-9 * static_cast<double>(std::max<std::int64_t>(stamp_ns - joint.estimates_ns, 0));
    const double fastest_rev_s =
        kOverspeed * joint.config.limits.velocity_rad_s * joint.config.gear_ratio / kTurn_rad;
    const double step_rev = std::abs(estimates.position_rev - joint.estimates.position_rev);
    // The stamp is the frame's; the measurement may have waited for the bus.
    const double waited_rev = std::abs(joint.estimates.velocity_rev_s) * (dt_s + kWaited_s);
    if (step_rev > std::max(fastest_rev_s * dt_s, waited_rev) + kJump_rev) {
      char text[96];
      std::snprintf(text, sizeof text, "the motor encoder jumped by %.2f revolutions in %.1f ms",
                    step_rev, 1e3 * dt_s);
      Fail(joint, FaultKind::kEncoderJump, text);
    }
  }
  joint.estimates = estimates;
  joint.estimates_ns = stamp_ns;
}

void CanPlant::TakeFromGateway(std::size_t gateway, const can::Received& received) {
  CompactLink& link = links_[gateway];
  switch (link.Take(received)) {
    case CompactLink::Taken::kComplete:
      break;
    case CompactLink::Taken::kRefused:
      ++malformed_;
      return;
    case CompactLink::Taken::kPart:
    case CompactLink::Taken::kNotOurs:
      return;
  }
  Answered(config_.gateways[gateway].bus, &references_ns_[gateway], received.stamp_ns);
  const can::CompactState& state = link.state();
  const std::vector<int>& fields = config_.gateways[gateway].joints;
  for (std::size_t field = 0; field < fields.size(); ++field) {
    Joint& joint = joints_[static_cast<std::size_t>(fields[field])];
    if (!CompactLink::Fits(state.position_turns[field])) {
      // Held at the end of its field: it may be anywhere beyond.
      Fail(joint, FaultKind::kOutOfRange, kBeyondCompact);
    }
    TakeEstimates(joint, {state.position_turns[field], state.velocity_turns_s[field]},
                  link.stamp_ns());
    joint.iq_A = state.iq_A[field];
    joint.iq_ns = link.stamp_ns();
  }
}

void CanPlant::TakeFromNode(Joint& joint, const can::Received& received) {
  switch (static_cast<can::NodeCommand>(can::AddressOf(received.frame)->command)) {
    case can::NodeCommand::kOutputEncoder:
      if (const auto m = can::DecodeOutputEncoder(received.frame)) {
        // A sequence number that stands still is an old measurement in a new frame.
        const bool fresh = joint.output_ns == 0 || m->sequence != joint.output.sequence;
        const can::OutputEncoder before = joint.output;
        joint.output = *m;
        if (!m->encoder_valid && joint.output_ns != 0) {  // the relays are told, the angle is not
          joint.output.angle_rad = before.angle_rad;
          joint.output.velocity_rad_s = before.velocity_rad_s;
        }
        if (fresh && m->encoder_valid) joint.output_ns = received.stamp_ns;
        return;
      }
      break;
    case can::NodeCommand::kJointSensors:
      if (const auto m = can::DecodeJointSensors(received.frame)) {
        joint.node_sensors = *m;
        joint.sensors_ns = received.stamp_ns;
        return;
      }
      break;
    default:
      return;
  }
  ++malformed_;
}

template <class Message>
void CanPlant::Send(const Joint& joint, const Message& message) {
  const can::Frame frame = can::Encode(joint.config.node, message, joint.config.firmware);
  Post(joint.config.bus, config_.short_frames ? can::Trim(frame) : frame);
}

void CanPlant::CommandJoint(Joint& joint, ControlMode mode, double torque_Nm, double position_rad,
                            double velocity_rad_s, double period_s, std::int64_t now_ns) {
  const bool closed_loop = joint.heartbeat.axis_state == can::AxisState::kClosedLoopControl;
  const bool heard_since = joint.heartbeat_ns > joint.phase_ns;
  if (mode == ControlMode::kIdle) {
    if (joint.phase != Phase::kIdle) {
      joint.phase = Phase::kIdle;
      joint.phase_ns = now_ns;
      SendIdle(joint, now_ns);
    } else if (closed_loop && heard_since && now_ns - joint.told_ns > kTellAgain_ns) {
      SendIdle(joint, now_ns);
    }
    SendNeutral(joint);
    return;
  }
  switch (joint.phase) {
    case Phase::kIdle:
      CheckZero(joint);
      if (joint.fault != FaultKind::kNone) break;
      joint.phase = Phase::kArming;
      joint.phase_ns = now_ns;
      joint.mode = mode;
      joint.sent_position_rad = joint.motor_position_rad() / joint.config.gear_ratio;
      SendArming(joint, now_ns);
      break;
    case Phase::kArming:
      if (joint.mode != mode) {
        joint.mode = mode;
        SendArming(joint, now_ns);
      }
      if (heard_since && closed_loop) {
        joint.phase = Phase::kActive;
        joint.phase_ns = now_ns;
        joint.sent_position_rad = joint.motor_position_rad() / joint.config.gear_ratio;
      } else if (now_ns - joint.phase_ns > Ns(config_.timing.closed_loop_timeout_s)) {
        Fail(joint, FaultKind::kNoClosedLoop, "the axis does not enter closed-loop control");
      } else if (now_ns - joint.told_ns > kTellAgain_ns) {
        SendArming(joint, now_ns);
      }
      break;
    case Phase::kActive:
      if (joint.mode != mode) {
        joint.mode = mode;
        joint.sent_position_rad = joint.motor_position_rad() / joint.config.gear_ratio;
        if (mode == ControlMode::kPosition) SendMeasuredPosition(joint);
        SendNeutral(joint);
        Send(joint, can::SetControllerMode{ToControlMode(mode), can::InputMode::kPassthrough});
      }
      if (heard_since && !closed_loop && joint.heartbeat.axis_error == 0)
        Fail(joint, FaultKind::kNoClosedLoop, "the axis left closed-loop control");
      break;
  }
  if (joint.phase == Phase::kActive && joint.fault == FaultKind::kNone) {
    SendSetpoint(joint, torque_Nm, position_rad, velocity_rad_s, period_s);
  } else {
    SendNeutral(joint);
  }
}

void CanPlant::SendArming(Joint& joint, std::int64_t now_ns) {
  const JointConfig& c = joint.config;
  joint.told_ns = now_ns;
  if (joint.mode == ControlMode::kPosition) SendMeasuredPosition(joint);
  Send(joint, can::SetControllerMode{ToControlMode(joint.mode), can::InputMode::kPassthrough});
  Send(joint,
       can::SetLimits{c.limits.velocity_rad_s * c.gear_ratio / kTurn_rad, c.limits.current_A});
  Send(joint, can::SetAxisState{can::AxisState::kClosedLoopControl});
}

// In front of position control: an axis goes to the setpoint it has, however old.
void CanPlant::SendMeasuredPosition(const Joint& joint) {
  Send(joint, can::SetInputPos{joint.estimates.position_rev, 0.0, 0.0});
}

void CanPlant::SendIdle(Joint& joint, std::int64_t now_ns) {
  joint.told_ns = now_ns;
  Send(joint, can::SetAxisState{can::AxisState::kIdle});
}

// Moves nothing in any mode, and feeds the watchdog.
void CanPlant::SendNeutral(Joint& joint) {
  if (joint.gateway >= 0) {
    const bool closed_loop = joint.heartbeat.axis_state == can::AxisState::kClosedLoopControl;
    if (!links_[static_cast<std::size_t>(joint.gateway)].SetReference(
            joint.field, joint.estimates.position_rev)) {
      Fail(joint, FaultKind::kOutOfRange, kBeyondCompact);
    }
    if (joint.phase == Phase::kIdle ? !closed_loop : joint.mode == ControlMode::kPosition) return;
  }
  if (joint.phase == Phase::kIdle || joint.mode == ControlMode::kTorque) {
    Send(joint, can::SetInputTorque{0.0});
  } else if (joint.mode == ControlMode::kPosition) {
    SendMeasuredPosition(joint);
  } else {
    Send(joint, can::SetInputVel{0.0, 0.0});
  }
}

double CanPlant::Revolutions(const Joint& joint, double position_rad) const {
  return joint.config.direction * position_rad * joint.config.gear_ratio / kTurn_rad +
         joint.config.zero_rev + joint.home_rev;
}

void CanPlant::Home(Joint& joint) {
  if (!joint.config.home_by_whole_turns) return;
  joint.home_rev = 0.0;
  const double off_rad =
      joint.motor_position_rad() - joint.config.gear_ratio * joint.position_rad();
  joint.home_rev = joint.config.direction * std::round(off_rad / kTurn_rad);
}

void CanPlant::CheckZero(Joint& joint) {
  if (!joint.config.zero_check) return;
  const double motor_rad = joint.motor_position_rad() / joint.config.gear_ratio;
  const double most_rad =
      0.5 * joint.config.zero_check->play_rad + joint.config.zero_check->tolerance_rad;
  if (std::abs(motor_rad - joint.position_rad()) <= most_rad) return;
  char text[160];
  std::snprintf(text, sizeof text,
                "zero check: the output is at %.4f rad by the motor and at %.4f rad by its own "
                "encoder, expected within %.4f rad",
                motor_rad, joint.position_rad(), most_rad);
  Fail(joint, FaultKind::kZero, text);
}

double CanPlant::LimitedTorque(const Joint& joint, double torque_Nm) const {
  const JointConfig& c = joint.config;
  const double most_Nm =
      std::min(c.limits.motor_torque_Nm, c.limits.current_A * c.torque_constant_Nm_A);
  double torque = std::clamp(torque_Nm, -most_Nm, most_Nm);
  // The motor's velocity: the output's is noisier, and inside the play it says nothing.
  const double velocity_rad_s = joint.motor_velocity_rad_s() / c.gear_ratio;
  const double forward_rad_s = torque > 0.0 ? velocity_rad_s : -velocity_rad_s;
  const double share =
      (c.limits.velocity_rad_s - forward_rad_s) / (kTaper * c.limits.velocity_rad_s);
  torque *= std::clamp(share, 0.0, 1.0);
  const double position_rad = joint.position_rad();
  if ((torque > 0.0 && position_rad > c.limits.upper_rad) ||
      (torque < 0.0 && position_rad < c.limits.lower_rad)) {
    torque = 0.0;
  }
  return torque;
}

void CanPlant::SendSetpoint(Joint& joint, double torque_Nm, double position_rad,
                            double velocity_rad_s, double period_s) {
  const JointConfig& c = joint.config;
  const double rev_per_rad = c.direction * c.gear_ratio / kTurn_rad;
  const double fastest_rad_s = c.limits.velocity_rad_s;
  switch (joint.mode) {
    case ControlMode::kTorque:
      Send(joint, can::SetInputTorque{c.direction * LimitedTorque(joint, torque_Nm) *
                                      c.controller_torque_constant_Nm_A / c.torque_constant_Nm_A});
      break;
    case ControlMode::kPosition: {
      const double wanted_rad = std::clamp(position_rad, c.limits.lower_rad, c.limits.upper_rad);
      const double step_rad = fastest_rad_s * period_s;
      joint.sent_position_rad +=
          std::clamp(wanted_rad - joint.sent_position_rad, -step_rad, step_rad);
      const bool free = wanted_rad == position_rad && joint.sent_position_rad == wanted_rad;
      const double ahead_rad_s =
          free ? std::clamp(velocity_rad_s, -fastest_rad_s, fastest_rad_s) : 0.0;
      const double wanted_rev = Revolutions(joint, joint.sent_position_rad);
      if (joint.gateway < 0) {
        Send(joint, can::SetInputPos{wanted_rev, ahead_rad_s * rev_per_rad, 0.0});
      } else if (!links_[static_cast<std::size_t>(joint.gateway)].SetReference(joint.field,
                                                                               wanted_rev)) {
        Fail(joint, FaultKind::kOutOfRange, "the reference is beyond the compact exchange");
      }
      break;
    }
    case ControlMode::kVelocity: {
      double wanted_rad_s = std::clamp(velocity_rad_s, -fastest_rad_s, fastest_rad_s);
      if ((wanted_rad_s > 0.0 && joint.position_rad() > c.limits.upper_rad) ||
          (wanted_rad_s < 0.0 && joint.position_rad() < c.limits.lower_rad)) {
        wanted_rad_s = 0.0;
      }
      Send(joint, can::SetInputVel{wanted_rad_s * rev_per_rad, 0.0});
      break;
    }
    case ControlMode::kIdle:
      break;
  }
}

void CanPlant::Assess(std::int64_t now_ns) {
  const BridgeTiming& timing = config_.timing;
  for (Joint& joint : joints_) {
    const JointLimits& limits = joint.config.limits;
    if (joint.phase != Phase::kActive && joint.fault == FaultKind::kNone &&
        joint.heartbeat.axis_error == can::axis_error::kWatchdogTimerExpired) {
      // Nobody fed an axis that held nothing, as between the start and the first cycle: no fault.
      // One that is just being armed is asked for closed loop again.
      joint.heartbeat.axis_error = 0;
      joint.cleared_ns = now_ns + kClearing_ns;
      Send(joint, can::ClearErrors{});
    }
    if (joint.heartbeat.axis_error != 0) {
      if (joint.fault == FaultKind::kNone) {
        Fail(joint, FaultKind::kAxisError, AxisErrorText(joint.heartbeat.axis_error).c_str());
      }
      if (!joint.asked_errors) {
        joint.asked_errors = true;
        for (const auto command :
             {Command::kGetMotorError, Command::kGetEncoderError, Command::kGetControllerError}) {
          if (can::Knows(joint.config.firmware, command)) Ask(joint, command);
        }
      }
    }
    const auto older = [now_ns](std::int64_t stamp_ns, double limit_s) {
      return now_ns - stamp_ns > Ns(limit_s);
    };
    if (older(joint.heartbeat_ns, timing.heartbeat_timeout_s)) {
      FailSilent(joint, FaultKind::kHeartbeatLost, "no heartbeat");
    }
    if (older(joint.estimates_ns, timing.lost_after_s)) {
      FailSilent(joint, FaultKind::kEstimatesLost, "no encoder estimates");
    }
    if (joint.config.output && (older(joint.output_ns, timing.lost_after_s) ||
                                older(joint.sensors_ns, timing.heartbeat_timeout_s))) {
      FailSilent(joint, FaultKind::kNodeLost, "nothing from the sensor node");
    }
    if (joint.config.output &&
        joint.node_sensors.motor_temperature_degC > limits.motor_temperature_degC) {
      Fail(joint, FaultKind::kOverTemperature, "motor too hot");
    }
    if (joint.phase == Phase::kActive) {
      if (std::abs(joint.motor_velocity_rad_s()) >
          kOverspeed * limits.velocity_rad_s * joint.config.gear_ratio) {
        Fail(joint, FaultKind::kOverspeed, "too fast");
      }
      const double position_rad = joint.position_rad();
      if (position_rad > limits.upper_rad + limits.margin_rad ||
          position_rad < limits.lower_rad - limits.margin_rad) {
        char text[64];
        std::snprintf(text, sizeof text, "at %.3f rad, outside its limits", position_rad);
        Fail(joint, FaultKind::kOutOfRange, text);
      }
    }
  }
}

void CanPlant::Fail(Joint& joint, FaultKind kind, const char* what) {
  if (joint.fault != FaultKind::kNone) return;  // the first one is the cause
  joint.fault = kind;
  joint.fault_told = false;
  joint.fault_text =
      "joint '" + joint.config.name + "' (node " + std::to_string(joint.config.node) + "): " + what;
}

void CanPlant::AppendError(Joint& joint, Command command, const char* who, std::uint64_t error) {
  const std::uint32_t bit = 1u << static_cast<unsigned>(command);
  if (error == 0 || joint.fault != FaultKind::kAxisError || (joint.answered & bit) != 0) return;
  joint.answered |= bit;
  char text[40];
  std::snprintf(text, sizeof text, ", %s 0x%llX", who, static_cast<unsigned long long>(error));
  joint.fault_text += text;
}

void CanPlant::FailSilent(Joint& joint, FaultKind kind, const char* what) {
  if (joint.fault != FaultKind::kNone) return;
  Fail(joint, kind, what);
  const can::Transport& bus = *transports_[static_cast<std::size_t>(joint.config.bus)];
  if (bus.link() != can::Link::kUp) {
    joint.fault_text += ", bus '" + bus.name() + "' is " + can::LinkName(bus.link());
  }
}

void CanPlant::Fill(std::int64_t now_ns, provider::PlantSensors* sensors) {
  const std::string* first = nullptr;  // fault's text
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    Joint& joint = joints_[j];
    const JointConfig& c = joint.config;
    sensors->position_rad[j] = joint.position_rad();
    sensors->velocity_rad_s[j] = joint.velocity_rad_s();
    sensors->motor_position_rad[j] = joint.motor_position_rad();
    sensors->motor_velocity_rad_s[j] = joint.motor_velocity_rad_s();
    sensors->motor_current_A[j] = c.direction * joint.iq_A;
    sensors->torque_Nm[j] =
        c.torque_efficiency * c.gear_ratio * c.torque_constant_Nm_A * sensors->motor_current_A[j];
    sensors->declared_payload_kg[j] = c.declared_payload_kg;
    std::int64_t oldest_ns = std::min(joint.estimates_ns, joint.iq_ns);
    if (c.output) {
      sensors->chamber_pressure_bar[j] = joint.node_sensors.chamber_pressure_bar;
      sensors->reservoir_pressure_bar[j] = joint.node_sensors.reservoir_pressure_bar;
      sensors->load_force_N[j] = joint.node_sensors.load_force_N;
      sensors->motor_temperature_degC[j] = joint.node_sensors.motor_temperature_degC;
      sensors->valve_open[j] = joint.output.valve_open;
      oldest_ns = std::min({oldest_ns, joint.output_ns, joint.sensors_ns});
    }
    const std::int64_t age_us =
        std::clamp<std::int64_t>((now_ns - oldest_ns) / 1000, 0, 2'000'000'000);
    sensors->age_us[j] = static_cast<std::int32_t>(age_us);
    sensors->joint_fault[j] = joint.fault_told = joint.fault != FaultKind::kNone;
    sensors->valid[j] = age_us * 1000 <= Ns(config_.timing.estimate_timeout_s);
    if (sensors->joint_fault[j] && first == nullptr) first = &joint.fault_text;
  }
  if (!links_.empty()) FillBody(now_ns);
  if (first == nullptr) {
    sensors->message.clear();
  } else if (sensors->message != *first) {
    sensors->message = *first;
  }
}

void CanPlant::FillBody(std::int64_t now_ns) {
  const CompactLink& link = links_.front();
  const can::CompactState& state = link.state();
  const bool fresh =
      link.stamp_ns() != 0 && now_ns - link.stamp_ns() <= Ns(config_.timing.estimate_timeout_s);
  body_.foot_force_N = state.force_N;
  body_.foot_valid.fill(fresh);
  body_.acceleration_m_s2 = state.acceleration_m_s2;
  body_.angular_velocity_rad_s = state.angular_velocity_rad_s;
  body_.orientation_wxyz = QuaternionOf(state.roll_pitch_yaw_rad);
  body_.imu_valid = fresh;
}

void CanPlant::Report(std::int64_t now_ns, double work_us) {
  work_.Add(work_us);
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    const can::TransportCounters counters = transports_[b]->counters();
    const can::Link link = transports_[b]->link();
    report_.up[b] = link == can::Link::kUp || link == can::Link::kPassive;
    report_.frames_sent[b] = counters.sent;
    report_.frames_received[b] = counters.received;
    report_.frames_dropped[b] = counters.dropped;
    report_.frames_lost[b] = counters.lost;
    report_.error_frames[b] = counters.error_frames;
  }
  const std::int64_t span_ns = now_ns - report_ns_;
  if (span_ns < 1'000'000'000) return;
  report_ns_ = now_ns;
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    const std::uint64_t bits = transports_[b]->counters().wire_bits;
    report_.load_percent[b] = 100.0 * static_cast<double>(bits - reported_bits_[b]) /
                              (config_.bitrate_bit_s[b] * 1e-9 * static_cast<double>(span_ns));
    reported_bits_[b] = bits;
    answers_[b].Tell(&report_.answer_p50_us[b], &report_.answer_max_us[b]);
  }
  work_.Tell(&report_.cycle_p50_us, &report_.cycle_max_us);
}

void CanPlant::Recent::Tell(double* median_us, double* most_us) {
  const auto end = static_cast<std::ptrdiff_t>(std::min(count, values_us.size()));
  count = 0;
  *median_us = *most_us = 0.0;
  if (end == 0) return;
  const auto begin = values_us.begin();  // the order they came in is of no use any more
  std::nth_element(begin, begin + end / 2, begin + end);
  *median_us = *(begin + end / 2);
  *most_us = *std::max_element(begin, begin + end);
}

}  // namespace sinew::bridge

#include "tests/fuzz/plant_watch.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>

#include "components/base/types/control_mode.h"

namespace sinew::fuzz {
namespace {

using types::ControlMode;
using types::FaultCause;

constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kTaper = 0.1;  // of the velocity limit, can_bridge.md
constexpr double kCommandDelay_s = bridge::Braking{}.command_delay_s;  // where none is declared
constexpr double kFloatStep = 2.5e-7;  // relative: twice the step of float32
constexpr double kReferenceRounding_rev = 0.00501;
constexpr double kSmallest = 1e-30;  // below it the float on the wire may be 0

double FloatAt(const can::Frame& frame, std::size_t byte) {
  float value = 0.0F;
  std::memcpy(&value, frame.data.data() + byte, sizeof value);  // little-endian, as this machine
  return static_cast<double>(value);
}
std::uint32_t WordAt(const can::Frame& frame, std::size_t byte) {
  std::uint32_t value = 0;
  std::memcpy(&value, frame.data.data() + byte, sizeof value);
  return value;
}
static_assert(std::endian::native == std::endian::little);

bool Near(double a, double b) {
  return std::abs(a - b) <= kFloatStep * std::max(std::abs(a), std::abs(b)) + kSmallest;
}

}  // namespace

PlantWatch::PlantWatch(const bridge::BridgeConfig& config) : config_(config) {
  for (auto& bus : axis_of_) bus.fill(-1);
  for (auto& bus : node_of_) bus.fill(-1);
  joints_.resize(config.joints.size());
  gateways_.resize(config.gateways.size());
  for (std::size_t j = 0; j < config.joints.size(); ++j) {
    const bridge::JointConfig& c = config.joints[j];
    axis_of_[std::size_t(c.bus)][std::size_t(c.node)] = static_cast<int>(j);
    if (c.output) node_of_[std::size_t(c.bus)][std::size_t(c.output->node)] = static_cast<int>(j);
  }
}

void PlantWatch::Received(int bus, const can::Frame& frame, std::int64_t now_ns) {
  ++counts_.received;
  if (frame.extended || frame.error || frame.remote || frame.id > 0x7FF || frame.length > 8) return;
  const std::size_t node = frame.id >> 5;
  const std::uint32_t kind = frame.id & 31;
  for (std::size_t g = 0; g < gateways_.size(); ++g) {
    const bridge::GatewayConfig& c = config_.gateways[g];
    if (c.bus == bus && std::size_t(c.node) == node) return ReceivedState(g, frame);
  }
  if (frame.length != 8) return;
  if (const int axis = axis_of_[std::size_t(bus)][node]; axis >= 0) {
    Joint& joint = joints_[std::size_t(axis)];
    if (kind == 0x01) {
      joint.closed_loop = frame.data[4] == 8;
      joint.heartbeat_ns = now_ns;
    } else if (kind == 0x09) {
      const double position_rev = FloatAt(frame, 0);
      const double velocity_rev_s = FloatAt(frame, 4);
      if (!std::isfinite(position_rev) || !std::isfinite(velocity_rev_s)) return;
      joint.position_rev = position_rev;
      joint.velocity_rev_s = velocity_rev_s;
      joint.measured = true;
    }
  } else if (const int owner = node_of_[std::size_t(bus)][node]; owner >= 0 && kind == 0x09) {
    Joint& joint = joints_[std::size_t(owner)];
    joint.output_rad = 1e-6 * static_cast<std::int32_t>(WordAt(frame, 0));
    if ((frame.data[7] & 1) != 0) joint.valid_output_rad = joint.output_rad;
  }
}

// Kinds 4 to 6 positions, 7 to 9 velocities, four fields each; all of 4 to 17 in their order.
void PlantWatch::ReceivedState(std::size_t g, const can::Frame& frame) {
  Gateway& gateway = gateways_[g];
  const std::uint32_t kind = frame.id & 31;
  if (kind < 4 || kind > 17 || frame.length < (kind == 17 ? 4 : 8)) return;
  if (kind == 4) gateway.next_kind = 4;
  for (std::size_t i = 0; i < 4 && kind <= 9; ++i) {
    const auto count = static_cast<std::int16_t>(frame.data[2 * i] | frame.data[2 * i + 1] << 8);
    const std::size_t field = (kind - 4) % 3 * 4 + i;
    (kind <= 6 ? gateway.position_rev[field] : gateway.velocity_rev_s[field]) =
        (kind <= 6 ? 0.01 : 0.1) * count;
  }
  if (kind != gateway.next_kind) {
    gateway.next_kind = 0;
    return;
  }
  if (++gateway.next_kind <= 17) return;
  const std::vector<int>& fields = config_.gateways[g].joints;
  for (std::size_t field = 0; field < fields.size(); ++field) {
    Joint& joint = joints_[std::size_t(fields[field])];
    joint.position_rev = gateway.position_rev[field];
    joint.velocity_rev_s = gateway.velocity_rev_s[field];
    joint.measured = true;
  }
}

void PlantWatch::Begin(const bridge::CanPlant& plant, const provider::PlantCommand& command,
                       double period_s) {
  plant_ = &plant;
  command_ = command;
  period_s_ = period_s;
  in_cycle_ = true;
  for (Joint& joint : joints_) {
    joint.looked_at = false;
    joint.setpoints = 0;
    joint.as_commanded = false;
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    if (command.mode[j] != ControlMode::kPosition) joints_[j].has_last_position = false;
  }
}

void PlantWatch::End() {
  in_cycle_ = false;
  for (const Joint& joint : joints_) {
    if (joint.setpoints > 0) continue;
    Break("a joint without a setpoint in a cycle", 0, can::Frame{});
  }
}

// At the first frame to a joint in a cycle the plant has decided whether it holds, arms or moves
// it.
void PlantWatch::LookAt(std::size_t j, std::int64_t now_ns) {
  Joint& joint = joints_[j];
  if (joint.looked_at) return;
  joint.looked_at = true;
  if (command_.mode[j] == ControlMode::kIdle) {
    joint.armed = false;
    return;
  }
  if (plant_->fault(static_cast<int>(j)) != FaultCause::kNone) return;
  if (!joint.armed) {
    joint.armed = true;
    joint.closed_since_armed = false;
    joint.armed_ns = now_ns;
    joint.has_last_position = false;
  } else if (joint.closed_loop && joint.heartbeat_ns > joint.armed_ns) {
    joint.closed_since_armed = true;
  }
}

bool PlantWatch::MayMove(std::size_t j) const {
  return joints_[j].armed && joints_[j].closed_since_armed &&
         plant_->fault(static_cast<int>(j)) == FaultCause::kNone;
}

double PlantWatch::OutputPosition(std::size_t j, bool valid_only) const {
  const bridge::JointConfig& c = config_.joints[j];
  const Joint& joint = joints_[j];
  if (c.output) {
    return c.output->direction *
           ((valid_only ? joint.valid_output_rad : joint.output_rad) - c.output->zero_rad);
  }
  return c.direction * kTurn_rad * (joint.position_rev - c.zero_rev) / c.gear_ratio;
}

void PlantWatch::Break(const char* rule, int bus, const can::Frame& frame) {
  if (counts_.violations++ == 0) {
    first_violation_ = std::string(rule) + ": bus " + std::to_string(bus) + ", " + Text(frame);
  }
}

void PlantWatch::Sent(int bus, const can::Frame& frame, std::int64_t now_ns) {
  ++counts_.sent;
  if (!can::IsValid(frame) || frame.extended || frame.error) {
    return Break("an impossible frame", bus, frame);
  }
  const std::size_t node = frame.id >> 5;
  const std::uint32_t kind = frame.id & 31;
  if (const int owner = node_of_[std::size_t(bus)][node]; owner >= 0) {
    if (frame.remote || kind != 0x0B || frame.length != 4) {
      return Break("not a frame for a sensor node", bus, frame);
    }
    if (in_cycle_) AssessValves(static_cast<std::size_t>(owner), bus, frame);
    return;
  }
  for (std::size_t g = 0; g < gateways_.size(); ++g) {
    const bridge::GatewayConfig& c = config_.gateways[g];
    if (c.bus == bus && std::size_t(c.node) == node) return AssessReferences(g, bus, frame, now_ns);
  }
  const int axis = axis_of_[std::size_t(bus)][node];
  if (axis < 0) return Break("a frame to a node that is not ours", bus, frame);
  const auto j = static_cast<std::size_t>(axis);
  if (frame.remote) {
    const bool known = kind == 0x03 || kind == 0x04 || kind == 0x09 || kind == 0x14 || kind == 0x1D;
    if (!known) Break("asks for what the bridge has no use for", bus, frame);
    return;
  }
  if (kind == 0x18) {  // Clear_Errors moves nothing
    if (frame.length != 0) Break("Clear_Errors with data", bus, frame);
    return;
  }
  // Outside a cycle (start, reset): idle and neutral only.
  if (in_cycle_) LookAt(j, now_ns);
  const bridge::JointConfig& c = config_.joints[j];
  const bool armed = in_cycle_ && joints_[j].armed;
  const ControlMode mode = command_.mode[j];
  switch (kind) {
    case 0x07: {
      const std::uint32_t state = frame.length >= 4 ? WordAt(frame, 0) : 0;
      if (state == 1) joints_[j].armed = false;
      if (state != 1 && !(state == 8 && armed)) Break("an axis state not asked for", bus, frame);
      return;
    }
    case 0x0B: {
      const std::uint32_t wanted = mode == ControlMode::kPosition   ? 3U
                                   : mode == ControlMode::kVelocity ? 2U
                                                                    : 1U;
      if (!armed || frame.length != 8 || WordAt(frame, 0) != wanted || WordAt(frame, 4) != 1U) {
        Break("a control mode not asked for", bus, frame);
      }
      return;
    }
    case 0x0F: {
      const double velocity_rev_s = c.limits.velocity_rad_s * c.gear_ratio / kTurn_rad;
      const bool with_current = c.firmware != can::Firmware::k0_5_1;
      if (!armed || frame.length != 8 || !Near(FloatAt(frame, 0), velocity_rev_s) ||
          (with_current && !Near(FloatAt(frame, 4), c.limits.current_A))) {
        Break("limits that are not the joint's", bus, frame);
      }
      return;
    }
    case 0x0C:
      return AssessPosition(j, bus, frame);
    case 0x0D:
      return AssessVelocity(j, bus, frame);
    case 0x0E:
      return AssessTorque(j, bus, frame);
    default:
      Break("a kind of frame the bridge does not have", bus, frame);
  }
}

double PlantWatch::Fastest(std::size_t j, bool up, bool valid_only, double forward_rad_s) const {
  const bridge::JointLimits& limits = config_.joints[j].limits;
  const double position_rad = OutputPosition(j, valid_only);
  const double way_rad = up ? limits.upper_rad - position_rad : position_rad - limits.lower_rad;
  const double latency_s = kCommandDelay_s + period_s_;
  const double left_rad = way_rad - std::max(forward_rad_s, 0.0) * latency_s;
  return limits.velocity_rad_s * std::sqrt(std::clamp(left_rad / limits.margin_rad, 0.0, 1.0));
}

template <class Allowed>
bool PlantWatch::IsAllowed(std::size_t j, double wire, Allowed allowed) {
  joints_[j].as_commanded = Near(wire, allowed(false));
  return joints_[j].as_commanded || wire == 0.0 || Near(wire, allowed(true));
}

void PlantWatch::AssessTorque(std::size_t j, int bus, const can::Frame& frame) {
  const bridge::JointConfig& c = config_.joints[j];
  Joint& joint = joints_[j];
  ++counts_.setpoints;
  ++joint.setpoints;
  if (frame.length < 4) return Break("a short setpoint", bus, frame);
  const double wire_Nm = FloatAt(frame, 0);
  if (wire_Nm != 0.0) ++counts_.moving;
  if (!in_cycle_ || !MayMove(j) || command_.mode[j] != ControlMode::kTorque) {
    if (wire_Nm != 0.0) Break("a torque for a joint that must not move", bus, frame);
    return;
  }
  const double most_Nm =
      std::min(c.limits.motor_torque_Nm, c.limits.current_A * c.torque_constant_Nm_A);
  const double held_Nm = std::clamp(command_.motor_torque_Nm[j], -most_Nm, most_Nm);
  const bool up = held_Nm > 0.0;
  const double speed_rad_s = c.direction * kTurn_rad * joint.velocity_rev_s / c.gear_ratio;
  const double forward_rad_s = up ? speed_rad_s : -speed_rad_s;
  const auto allowed_Nm = [&](bool valid_only) {
    const double fastest_rad_s = Fastest(j, up, valid_only, forward_rad_s);
    const double taper = (fastest_rad_s - forward_rad_s) / (kTaper * fastest_rad_s);
    return taper > 0.0 && std::isfinite(taper)
               ? c.direction * held_Nm * std::min(taper, 1.0) * c.controller_torque_constant_Nm_A /
                     c.torque_constant_Nm_A
               : 0.0;
  };
  if (!IsAllowed(j, wire_Nm, allowed_Nm)) Break("another torque than commanded", bus, frame);
}

void PlantWatch::AssessVelocity(std::size_t j, int bus, const can::Frame& frame) {
  const bridge::JointConfig& c = config_.joints[j];
  Joint& joint = joints_[j];
  ++counts_.setpoints;
  ++joint.setpoints;
  if (!in_cycle_ || command_.mode[j] != ControlMode::kVelocity) {
    return Break("a velocity for a joint in another mode", bus, frame);
  }
  if (frame.length != 8 || !(FloatAt(frame, 4) == 0.0)) {
    return Break("a velocity with a torque that was not commanded", bus, frame);
  }
  const double wire_rev_s = FloatAt(frame, 0);
  if (wire_rev_s != 0.0) ++counts_.moving;
  if (!MayMove(j)) {
    if (wire_rev_s != 0.0) Break("a velocity for a joint that must not move", bus, frame);
    return;
  }
  const double speed_rad_s = c.direction * kTurn_rad * joint.velocity_rev_s / c.gear_ratio;
  const auto allowed_rev_s = [&](bool valid_only) {
    return c.direction * c.gear_ratio / kTurn_rad *
           std::clamp(command_.velocity_rad_s[j], -Fastest(j, false, valid_only, -speed_rad_s),
                      Fastest(j, true, valid_only, speed_rad_s));
  };
  if (!IsAllowed(j, wire_rev_s, allowed_rev_s)) {
    Break("another velocity than commanded", bus, frame);
  }
}

void PlantWatch::AssessPosition(std::size_t j, int bus, const can::Frame& frame) {
  const bridge::JointConfig& c = config_.joints[j];
  Joint& joint = joints_[j];
  ++counts_.setpoints;
  ++joint.setpoints;
  if (!in_cycle_ || command_.mode[j] != ControlMode::kPosition) {
    return Break("a position for a joint in another mode", bus, frame);
  }
  const double wire_rev = FloatAt(frame, 0);
  const auto ahead = static_cast<std::int16_t>(WordAt(frame, 4) & 0xFFFF);
  const auto torque = static_cast<std::int16_t>(WordAt(frame, 4) >> 16);
  if (frame.length != 8 || torque != 0 || !std::isfinite(wire_rev)) {
    return Break("a position that is not finite, or with a torque", bus, frame);
  }
  const double most_rev_s = c.limits.velocity_rad_s * c.gear_ratio / kTurn_rad;
  if (std::abs(0.001 * ahead) > most_rev_s + 0.001) {
    return Break("a feed-forward above the velocity limit", bus, frame);
  }
  // The position of a gateway is no float32.
  const bool neutral = joint.measured && Near(wire_rev, joint.position_rev) && ahead == 0;
  if (!MayMove(j)) {
    if (!neutral) Break("a position for a joint that must not move", bus, frame);
    return;
  }
  AssessStep(j, wire_rev, 0.0, bus, frame);
}

// Four fields of 0.01 turns, for the joints of a gateway.
void PlantWatch::AssessReferences(std::size_t g, int bus, const can::Frame& frame,
                                  std::int64_t now_ns) {
  const std::uint32_t kind = frame.id & 31;
  if (frame.remote || kind < 1 || kind > 3 || frame.length != 8) {
    return Break("not a frame for a gateway", bus, frame);
  }
  const std::vector<int>& fields = config_.gateways[g].joints;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t field = (kind - 1) * 4 + i;
    const auto count = static_cast<std::int16_t>(frame.data[2 * i] | frame.data[2 * i + 1] << 8);
    if (field >= fields.size()) {
      if (count != 0) Break("a reference for an unused field", bus, frame);
      continue;
    }
    const auto j = static_cast<std::size_t>(fields[field]);
    Joint& joint = joints_[j];
    if (in_cycle_) LookAt(j, now_ns);
    ++counts_.setpoints;
    ++joint.setpoints;
    const double wire_rev = 0.01 * count;
    const bool still = wire_rev == joint.last_reference_rev;
    const bool where_it_is =
        joint.measured && std::abs(wire_rev - joint.position_rev) <= kReferenceRounding_rev;
    if (in_cycle_ && MayMove(j) && command_.mode[j] == ControlMode::kPosition) {
      AssessStep(j, wire_rev, 2.0 * kReferenceRounding_rev, bus, frame);
    } else if (!where_it_is && !still) {
      Break("a reference for a joint that must not move", bus, frame);
    } else if (!where_it_is && joint.armed && command_.mode[j] == ControlMode::kPosition &&
               plant_->fault(static_cast<int>(j)) == FaultCause::kNone) {
      Break("an old reference for a joint that is being armed", bus, frame);
    }
    joint.last_reference_rev = wire_rev;
  }
}

// A position for a joint that may move.
void PlantWatch::AssessStep(std::size_t j, double wire_rev, double rounding_rev, int bus,
                            const can::Frame& frame) {
  const bridge::JointConfig& c = config_.joints[j];
  Joint& joint = joints_[j];
  const double most_rev_s = c.limits.velocity_rad_s * c.gear_ratio / kTurn_rad;
  joint.as_commanded = true;
  const double step_rev = most_rev_s * period_s_;
  const double slack_rev = 4.0 * kFloatStep * std::abs(wire_rev) + 1e-5 + rounding_rev;
  const auto within_a_step = [&](double from_rev) {
    return std::abs(wire_rev - from_rev) <= step_rev + slack_rev;
  };
  const bool from_measured = within_a_step(joint.position_rev);
  const bool from_last = joint.has_last_position && within_a_step(joint.last_position_rev);
  const double base_rev = from_last ? joint.last_position_rev : joint.position_rev;
  if (!from_measured && !from_last) Break("a position too far in one cycle", bus, frame);
  // Beyond a limit it may only come back.
  const double limits_rev[2] = {
      c.direction * c.limits.lower_rad * c.gear_ratio / kTurn_rad + c.zero_rev,
      c.direction * c.limits.upper_rad * c.gear_ratio / kTurn_rad + c.zero_rev};
  const double lower_rev = std::min(limits_rev[0], limits_rev[1]);
  const double upper_rev = std::max(limits_rev[0], limits_rev[1]);
  const auto outside = [&](double rev) {
    return std::max({rev - upper_rev, lower_rev - rev, 0.0});
  };
  const double before = std::max(outside(base_rev), outside(joint.position_rev));
  if (outside(wire_rev) > before + slack_rev) {
    Break("a position outwards beyond a limit", bus, frame);
  }
  if (wire_rev != joint.position_rev) ++counts_.moving;
  joint.last_position_rev = wire_rev;
  joint.has_last_position = true;
}

void PlantWatch::AssessValves(std::size_t j, int bus, const can::Frame& frame) {
  const unsigned wanted = (command_.valve_open[j] ? 1U : 0U) |
                          (command_.compressor_on[j] ? 2U : 0U) | (command_.vent_open[j] ? 4U : 0U);
  const std::uint32_t timeout_ms = WordAt(frame, 0) >> 16;
  if (frame.data[0] != wanted ||
      timeout_ms != static_cast<std::uint32_t>(config_.timing.valve_timeout_ms)) {
    Break("relays other than commanded", bus, frame);
  }
}

}  // namespace sinew::fuzz

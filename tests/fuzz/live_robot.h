// The working part of a fuzzed bus: controllers and sensor nodes with correct messages, so that
// there is a robot to move. Joints swing past their limits in position and up to those in velocity;
// controllers are in closed loop from the moment of the request.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "bridge/can/codec.h"
#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"
#include "bridge/joints/can_plant.h"

namespace sinew::fuzz {

class LiveRobot {
 public:
  explicit LiveRobot(const bridge::BridgeConfig& config)
      : config_(config), closed_loop_(config.joints.size(), false) {}

  double amplitude_rad = 1.6;
  double frequency_rad_s = 2.4;
  bool closes_loop = true;  // false: ignores the request of closed loop

  // What the bridge sent.
  void Take(int bus, const can::Frame& frame) {
    const auto state = can::Decode<can::SetAxisState>(frame);
    if (!state) return;
    const int node = can::AddressOf(frame)->node;
    for (std::size_t j = 0; j < closed_loop_.size(); ++j) {
      if (config_.joints[j].bus != bus || config_.joints[j].node != node) continue;
      closed_loop_[j] = closes_loop && state->state == can::AxisState::kClosedLoopControl;
    }
  }

  // Frames of this moment on this bus: estimates and output encoders always, the rest every fifth
  // time and when `all`.
  void SendMessages(int bus, double time_s, bool all, std::vector<can::Frame>* frames) {
    ++sequence_;
    const bool slow = all || sequence_ % 5 == 0;
    for (std::size_t j = 0; j < closed_loop_.size(); ++j) {
      const bridge::JointConfig& c = config_.joints[j];
      if (c.bus != bus) continue;
      const double phase = frequency_rad_s * time_s + static_cast<double>(j);
      const double angle_rad = amplitude_rad * std::sin(phase);
      const double velocity_rad_s = amplitude_rad * frequency_rad_s * std::cos(phase);
      const double rev_per_rad = c.direction * c.gear_ratio / (2.0 * std::numbers::pi);
      if (slow) {
        frames->push_back(
            can::Encode(c.node,
                        can::Heartbeat{0, closed_loop_[j] ? can::AxisState::kClosedLoopControl
                                                          : can::AxisState::kIdle},
                        c.firmware));
        frames->push_back(can::Encode(c.node, can::Iq{0.5, 0.5}, c.firmware));
      }
      const can::EncoderEstimates estimates{angle_rad * rev_per_rad + c.zero_rev,
                                            velocity_rad_s * rev_per_rad};
      if (const int field = FieldOf(j); field >= 0) {
        state_.position_turns[std::size_t(field)] = estimates.position_rev;
        state_.velocity_turns_s[std::size_t(field)] = estimates.velocity_rev_s;
      } else {
        frames->push_back(can::Encode(c.node, estimates, c.firmware));
      }
      if (!c.output) continue;
      can::OutputEncoder output;
      output.angle_rad = c.output->direction * angle_rad + c.output->zero_rad;
      output.velocity_rad_s = c.output->direction * velocity_rad_s;
      output.sequence = sequence_;
      output.encoder_valid = output.pressure_valid = output.load_valid = true;
      frames->push_back(can::Encode(c.output->node, output));
      if (slow) {
        frames->push_back(can::Encode(c.output->node, can::JointSensors{4.0, 6.0, 12.0, 31.0}));
      }
    }
    for (const bridge::GatewayConfig& gateway : config_.gateways) {
      if (gateway.bus != bus) continue;
      for (const can::Frame& frame : can::EncodeState(gateway.node, state_)) {
        frames->push_back(frame);
      }
    }
  }

 private:
  // Of a joint behind the one gateway; -1: it is behind none.
  int FieldOf(std::size_t joint) const {
    for (const bridge::GatewayConfig& gateway : config_.gateways) {
      for (std::size_t field = 0; field < gateway.joints.size(); ++field) {
        if (std::size_t(gateway.joints[field]) == joint) return static_cast<int>(field);
      }
    }
    return -1;
  }

  bridge::BridgeConfig config_;
  std::vector<bool> closed_loop_;
  std::uint8_t sequence_ = 0;
  can::CompactState state_;
};

}  // namespace sinew::fuzz

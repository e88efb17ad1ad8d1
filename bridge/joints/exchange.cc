#include "bridge/joints/exchange.h"

#include "components/base/types/angle.h"

namespace sinew::bridge {
namespace {

using types::ControlMode;

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

bool RequestsIdle(const can::Frame& frame) {
  const auto request = can::Decode<can::SetAxisState>(frame);
  return request && request->state == can::AxisState::kIdle;
}

bool IsWithheld(const can::Frame& frame, const can::Frame& lost) {
  const auto address = can::AddressOf(frame), other = can::AddressOf(lost);
  return address && other && address->node == other->node && !frame.remote && !RequestsIdle(frame);
}

}  // namespace

FrameOutbox::FrameOutbox(std::size_t buses) : frames_(buses) {
  for (auto& frames : frames_) frames.reserve(kFramesOfCycle);
}

void FrameOutbox::Flush(std::span<can::Transport* const> transports) {
  for (std::size_t b = 0; b < frames_.size(); ++b) {
    std::vector<can::Frame>& frames = frames_[b];
    while (!frames.empty()) {
      const std::size_t sent = transports[b]->SendAll(frames);
      if (sent == frames.size()) break;
      const can::Frame lost = frames[sent];
      frames.erase(frames.begin(), frames.begin() + static_cast<std::ptrdiff_t>(sent) + 1);
      std::erase_if(frames, [&lost](const can::Frame& frame) { return IsWithheld(frame, lost); });
    }
    frames.clear();
  }
}

void JointExchange::RequestClosedLoop(ControlMode mode, const JointMeasurement& measured) {
  if (mode == ControlMode::kPosition) SendMeasuredPosition(measured);
  RequestMode(mode);
  const JointLimits& limits = joint_.limits;
  Send(can::SetLimits{limits.velocity_rad_s * joint_.gear_ratio / types::kTwoPi, limits.current_A});
  Send(can::SetAxisState{can::AxisState::kClosedLoopControl});
}

void JointExchange::RequestMode(ControlMode mode) {
  Send(can::SetControllerMode{ToControlMode(mode), can::InputMode::kPassthrough});
}

void JointExchange::SendMeasuredPosition(const JointMeasurement& measured) {
  Send(can::SetInputPos{measured.estimates.position_rev, 0.0, 0.0});
}

void JointExchange::RequestData(can::Command command) {
  outbox_->Post(joint_.bus, can::EncodeRequest(joint_.node, command));
}

void JointExchange::SendNeutralFrame(ControlMode mode, const JointMeasurement& measured) {
  switch (mode) {
    case ControlMode::kIdle:
    case ControlMode::kTorque:
      Send(can::SetInputTorque{0.0});
      break;
    case ControlMode::kPosition:
      SendMeasuredPosition(measured);
      break;
    case ControlMode::kVelocity:
      Send(can::SetInputVel{0.0, 0.0});
      break;
  }
}

bool DirectExchange::SendPosition(double position_rev, double feed_forward_rev_s) {
  Send(can::SetInputPos{position_rev, feed_forward_rev_s, 0.0});
  return true;
}

bool DirectExchange::SendNeutral(ControlMode mode, const JointMeasurement& measured) {
  SendNeutralFrame(mode, measured);
  return true;
}

bool GatewayExchange::SendPosition(double position_rev, double /*feed_forward_rev_s*/) {
  return link_->SetReference(field_, position_rev);
}

// The reference holds an axis in position control and feeds the watchdog of every axis. An axis
// that should be idle but is not may be in any mode: it gets a setpoint of its own.
bool GatewayExchange::SendNeutral(ControlMode mode, const JointMeasurement& measured) {
  const bool fits = link_->SetReference(field_, measured.estimates.position_rev);
  const bool reference_suffices =
      mode == ControlMode::kIdle ? !measured.closed_loop() : mode == ControlMode::kPosition;
  if (!reference_suffices) SendNeutralFrame(mode, measured);
  return fits;
}

}  // namespace sinew::bridge

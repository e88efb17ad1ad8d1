#include "bridge/virtual_axes/gateway_model.h"

#include <algorithm>
#include <cmath>

namespace sinew::virtual_axes {

bool GatewayModel::Take(const can::Frame& frame, std::span<AxisModel> axes, std::int64_t now_ns) {
  if (!can::DecodeReferences(config_.node, frame, &references_)) return false;
  const int number = can::ReferenceFrameNumber(config_.node, frame);
  constexpr std::size_t kFields = can::kCompactJoints / can::kCompactReferenceFrames;
  const std::size_t first = kFields * static_cast<std::size_t>(number);
  for (std::size_t i = first; i < std::min(first + kFields, axes_.size()); ++i) {
    axes[axes_[i]].TakeReference(references_.position_turns[i], now_ns);
  }
  return number == can::kCompactReferenceFrames - 1;
}

std::array<can::Frame, can::kCompactStateFrames> GatewayModel::State(
    std::span<AxisModel> axes, const provider::PlantSensors& sensors,
    const provider::BodySensors* body, std::int64_t now_ns) {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    AxisModel& axis = axes[axes_[i]];
    if (axis.is_silent(now_ns)) continue;
    const MotorState motor = axis.Reported(sensors, now_ns);
    state_.position_turns[i] = motor.position_rev;
    state_.velocity_turns_s[i] = motor.velocity_rev_s;
    state_.iq_A[i] = motor.iq_A;
  }
  if (body != nullptr) {
    state_.force_N = body->foot_force_N;
    state_.acceleration_m_s2 = body->acceleration_m_s2;
    state_.angular_velocity_rad_s = body->angular_velocity_rad_s;
    state_.roll_pitch_yaw_rad = RollPitchYaw(body->orientation_wxyz);
  }
  ++state_.sequence;
  return can::EncodeState(config_.node, state_);
}

std::array<double, 3> RollPitchYaw(const std::array<double, 4>& orientation_wxyz) {
  const auto [w, x, y, z] = orientation_wxyz;
  return {std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y)),
          std::asin(std::clamp(2.0 * (w * y - z * x), -1.0, 1.0)),
          std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))};
}

}  // namespace sinew::virtual_axes

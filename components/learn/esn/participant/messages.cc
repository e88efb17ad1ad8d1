#include "components/learn/esn/participant/messages.h"

#include <algorithm>
#include <limits>

#include "components/base/types/joints.h"

namespace sinew::esn {
namespace {

int Count(int joint_count) { return std::min(joint_count, types::kMaxJoints); }

}  // namespace

bool FillFrom(const msg::JointState& message, Frame* frame) {
  bool all_valid = true;
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kPosition, j, message.position_rad[at]);
    frame->Set(Signal::kVelocity, j, message.velocity_rad_s[at]);
    all_valid = all_valid && message.valid[at];
  }
  return all_valid;
}

bool FillFrom(const msg::ActuatorState& message, Frame* frame) {
  bool all_valid = true;
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kMotorVelocity, j, message.motor_velocity_rad_s[at]);
    frame->Set(Signal::kChamberPressure, j, message.chamber_pressure_bar[at]);
    frame->Set(Signal::kLoadForce, j, message.load_force_N[at]);
    frame->Set(Signal::kPayload, j, message.declared_payload_kg[at]);
    frame->Set(Signal::kTemperature, j, message.motor_temperature_degC[at]);
    all_valid = all_valid && message.valid[at];
  }
  return all_valid;
}

bool FillFrom(const msg::Reference& message, Frame* frame) {
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    frame->Set(Signal::kReferencePosition, j, message.position_rad[at]);
    frame->Set(Signal::kReferenceVelocity, j, message.velocity_rad_s[at]);
    frame->Set(Signal::kReferenceAcceleration, j, message.acceleration_rad_s2[at]);
    frame->Set(Signal::kReferenceDirection, j, ReferenceDirection(message.velocity_rad_s[at]));
  }
  return !message.stale;
}

bool FillFrom(const msg::RegimeState& message, Frame* frame) {
  for (int j = 0; j < Count(message.joint_count); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const bool known = message.regime[at] != types::Regime::kUnknown;
    frame->Set(Signal::kPlayAngle, j,
               known ? message.play_angle_rad[at] : std::numeric_limits<double>::quiet_NaN());
  }
  return !message.stale;
}

types::Regime RegimeOf(const msg::RegimeState& message) {
  if (message.joint_count == 0) return types::Regime::kUnknown;
  return message.regime[0];
}

bool TakeReadout(const msg::Readout& message, Predictor* predictor) {
  if (message.feature_count == 0 || message.network > 1) return true;  // nothing to say yet
  const Which which = static_cast<Which>(message.network);
  if (!predictor->has(which)) return false;
  if (predictor->readout_version(which) == message.version) return true;
  const Eigen::Index rows = message.output_count;
  const Eigen::Index columns = message.feature_count;
  if (static_cast<std::size_t>(rows * columns) != message.weight.size()) return false;
  const Eigen::MatrixXd readout =
      Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
          message.weight.data(), rows, columns);
  return predictor->SetReadout(which, message.version, readout);
}

msg::TorquePrediction ToMessage(const Prediction& prediction) {
  msg::TorquePrediction message;
  message.joint_count = static_cast<std::uint8_t>(prediction.joint_count);
  message.torque_Nm = prediction.torque_Nm;
  message.sea_torque_Nm = prediction.sea_torque_Nm;
  message.pea_torque_Nm = prediction.pea_torque_Nm;
  message.valid = prediction.valid;
  return message;
}

msg::ReservoirState ReservoirMessage(const Prediction& prediction, const Predictor& predictor) {
  msg::ReservoirState message;
  if (!prediction.chosen) return message;
  const Network& network = predictor.network(*prediction.chosen);
  message.network = static_cast<std::uint8_t>(*prediction.chosen);
  message.output_count = static_cast<std::uint8_t>(network.output_count());
  message.feature_count = static_cast<std::uint16_t>(network.feature_count());
  message.feature.assign(network.features().data(),
                         network.features().data() + network.feature_count());
  message.prediction_Nm = prediction.torque_Nm;
  message.readout_version = predictor.readout_version(*prediction.chosen);
  return message;
}

}  // namespace sinew::esn

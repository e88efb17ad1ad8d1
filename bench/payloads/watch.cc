#include "bench/payloads/watch.h"

#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/performance.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/residual.h>
#include <sinew_idl/simulation.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "components/topics/node/topics.h"

namespace sinew::payloads {
namespace {

bool IsFinite(double value) { return std::isfinite(value); }

template <class... Ranges>
std::string Finite(const Ranges&... values) {
  const bool good = (std::all_of(values.begin(), values.end(), IsFinite) && ...);
  return good ? "" : "a number that is not finite";
}

std::string Check(const msg::JointCommand& m) {
  for (const double torque_Nm : m.motor_torque_Nm) {
    if (std::abs(torque_Nm) > kMotorTorqueLimit_Nm) return "a motor torque above its limit";
  }
  return Finite(m.motor_torque_Nm, m.position_rad, m.velocity_rad_s);
}
std::string Check(const msg::Reference& m) {
  return Finite(m.position_rad, m.velocity_rad_s, m.acceleration_rad_s2);
}
std::string Check(const msg::TorquePrediction& m) {
  for (std::size_t j = 0; j < m.valid.size(); ++j) {
    if (m.valid[j] && !IsFinite(m.torque_Nm[j])) return "a valid torque that is not finite";
  }
  return "";
}
std::string Check(const msg::RegimeState& m) { return Finite(m.play_angle_rad, m.confidence); }
std::string Check(const msg::MotionRequest& m) {
  return Finite(m.target_rad, m.velocity_limit_rad_s, m.motor_torque_limit_Nm, m.pressure_bar);
}
std::string Check(const msg::ReservoirState& m) {
  return m.feature.size() == m.feature_count ? "" : "another number of features than it says";
}
std::string Check(const msg::Readout& m) {
  if (m.weight.size() != std::size_t{m.output_count} * m.feature_count) {
    return "another number of weights than it says";
  }
  return Finite(m.weight);
}
std::string Check(const msg::PneumaticState& m) {
  return Finite(m.target_pressure_bar, m.pressure_bar, m.stiffness_Nm_rad);
}
std::string Check(const msg::ResidualState& m) {
  return Finite(m.learnt_share, m.residual_Nm, m.rms_Nm, m.statistic, m.follows_share, m.change,
                m.change_error);
}
std::string Check(const msg::PerformanceState& m) {
  return Finite(
      m.error_rad, m.sliding_rms_rad, m.window_share, m.mean_square_error_rad2, m.absolute_work_J,
      m.positive_work_J, m.net_work_J, m.electrical_J,
      std::array{m.robot_mean_square_error_rad2, m.robot_absolute_work_J, m.robot_positive_work_J,
                 m.robot_net_work_J, m.robot_electrical_J, m.rise_m, m.lifting_work_J});
}
std::string Check(const msg::AdaptationState& m) {
  std::string wrong = Finite(m.innovation_Nm);
  if (!IsFinite(m.clipped_share) || !IsFinite(m.covariance_trace)) wrong = Finite(std::array{NAN});
  return wrong;
}
std::string Check(const msg::SimPressure& m) { return Finite(m.chamber_pressure_bar); }
std::string Check(const msg::ValveCommand&) { return ""; }

template <class Message>
std::string AssessAs(const node::Bytes& payload) {
  thread_local Message message;
  if (!node::Decode(payload, &message)) return "a malformed message";
  return Check(message);
}

}  // namespace

std::string Assess(std::string_view topic, const node::Bytes& payload) {
  using Function = std::string (*)(const node::Bytes&);
  static const std::map<std::string_view, Function> kFunctions = {
      {node::kJointCommand.name, AssessAs<msg::JointCommand>},
      {node::kReference.name, AssessAs<msg::Reference>},
      {node::kTorquePrediction.name, AssessAs<msg::TorquePrediction>},
      {node::kRegime.name, AssessAs<msg::RegimeState>},
      {node::kMotionRequest.name, AssessAs<msg::MotionRequest>},
      {node::kReservoirState.name, AssessAs<msg::ReservoirState>},
      {node::kReadout.name, AssessAs<msg::Readout>},
      {node::kPneumaticState.name, AssessAs<msg::PneumaticState>},
      {node::kResidual.name, AssessAs<msg::ResidualState>},
      {node::kPerformance.name, AssessAs<msg::PerformanceState>},
      {node::kAdaptationState.name, AssessAs<msg::AdaptationState>},
      {node::kSimPressure.name, AssessAs<msg::SimPressure>},
      {node::kValveCommand.name, AssessAs<msg::ValveCommand>},
  };
  const auto found = kFunctions.find(topic);
  return found == kFunctions.end() ? "" : found->second(payload);
}

}  // namespace sinew::payloads

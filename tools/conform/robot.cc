#include "tools/conform/robot.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/simulation.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "components/topics/node/topics.h"

namespace sinew::conform {

namespace {

// A slow swing, inside every limit of a robot; motors behind the gears of the rig
// (robots/rig/surrogate_model.yaml) in the middle of their play.
constexpr double kAmplitude_rad = 0.2;
constexpr double kSwing_rad_s = 2.0 * std::numbers::pi * 0.5;
constexpr double kGearRatio = 100.0;
constexpr double kBacklash_rad = 0.0464;
constexpr double kPressure_bar = 4.0;
constexpr double kReferenceAhead_rad = 0.002;  // there is always something to regulate
constexpr double kPrediction_Nm = 0.3;
constexpr double kOtherMotorTorque_Nm = 0.002;  // of the joint_command that is played
constexpr double kAmbient_degC = 20.0;
constexpr std::uint64_t kForeignSession = 0xF0F0F0F0F0F0F0F0u;
constexpr double kNs_s = 1e9;

struct Swing {
  double position_rad, velocity_rad_s, acceleration_rad_s2;
};

Swing SwingAt(const Moment& moment) {
  const double angle_rad = kSwing_rad_s * static_cast<double>(moment.tick) * moment.period_s;
  return {kAmplitude_rad * std::sin(angle_rad), kAmplitude_rad * kSwing_rad_s * std::cos(angle_rad),
          -kAmplitude_rad * kSwing_rad_s * kSwing_rad_s * std::sin(angle_rad)};
}

template <class Message>
Message WithJoints(const Moment& moment) {
  Message message;
  message.joint_count = static_cast<std::uint8_t>(moment.joints);
  return message;
}

msg::JointState MakeJointState(const Moment& moment) {
  auto message = WithJoints<msg::JointState>(moment);
  message.robot_state = moment.robot_state;
  message.last_tick = moment.last_tick;
  message.period_s = moment.period_s;
  message.measured_period_s = moment.period_s;
  const Swing swing = SwingAt(moment);
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.position_rad[j] = moment.positions_are_nan ? std::nan("") : swing.position_rad;
    message.velocity_rad_s[j] = swing.velocity_rad_s;
    message.valid[j] = true;
  }
  return message;
}

msg::ActuatorState MakeActuatorState(const Moment& moment) {
  auto message = WithJoints<msg::ActuatorState>(moment);
  message.measured_flags = ~0u;  // every signal
  const Swing swing = SwingAt(moment);
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.motor_position_rad[j] = kGearRatio * swing.position_rad;
    message.motor_velocity_rad_s[j] = kGearRatio * swing.velocity_rad_s;
    message.motor_temperature_degC[j] = kAmbient_degC;
    message.chamber_pressure_bar[j] = kPressure_bar;
    message.reservoir_pressure_bar[j] = kPressure_bar;
    message.valve_open[j] = moment.valve_open;
    message.valid[j] = true;
  }
  return message;
}

msg::Reference MakeReference(const Moment& moment) {
  auto message = WithJoints<msg::Reference>(moment);
  message.state_tick = moment.tick;
  const Swing swing = SwingAt(moment);
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.position_rad[j] = swing.position_rad + kReferenceAhead_rad;
    message.velocity_rad_s[j] = swing.velocity_rad_s;
    message.acceleration_rad_s2[j] = swing.acceleration_rad_s2;
    if (!moment.reference_is_nan) continue;
    message.position_rad[j] = message.velocity_rad_s[j] = std::nan("");
  }
  return message;
}

msg::RegimeState MakeRegime(const Moment& moment) {
  auto message = WithJoints<msg::RegimeState>(moment);
  message.state_tick = moment.tick;
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.phase[j] = msg::RegimePhase::kExecution;
    message.regime[j] = msg::RegimeKind::kSea;
    message.play_angle_rad[j] = 0.5 * kBacklash_rad;
    message.backlash_rad[j] = kBacklash_rad;
    message.confidence[j] = 1.0;
  }
  return message;
}

msg::TorquePrediction MakeTorquePrediction(const Moment& moment) {
  auto message = WithJoints<msg::TorquePrediction>(moment);
  message.state_tick = moment.tick;
  message.reference_tick = moment.tick;
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.torque_Nm[j] = message.sea_torque_Nm[j] = message.pea_torque_Nm[j] = kPrediction_Nm;
    message.valid[j] = true;
  }
  return message;
}

// No network counts: whatever networks the program has, this fits them.
msg::ReservoirState MakeReservoirState(const Moment&) { return {}; }
// The same: no readout yet.
msg::Readout MakeReadout(const Moment&) { return {}; }

msg::JointCommand MakeJointCommand(const Moment& moment) {
  auto message = WithJoints<msg::JointCommand>(moment);
  message.reference_tick = moment.tick;
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.mode[j] = msg::CommandMode::kTorque;
    message.motor_torque_Nm[j] = kOtherMotorTorque_Nm;
  }
  return message;
}

msg::ValveCommand MakeValveCommand(const Moment& moment) {
  return WithJoints<msg::ValveCommand>(moment);
}

msg::PneumaticState MakePneumaticState(const Moment& moment) {
  return WithJoints<msg::PneumaticState>(moment);
}

msg::AdaptationState MakeAdaptationState(const Moment&) { return {}; }

msg::MotionRequest MakeMotionRequest(const Moment& moment) {
  auto message = WithJoints<msg::MotionRequest>(moment);
  message.requester = "conform";
  return message;
}

msg::SimTruth MakeSimTruth(const Moment& moment) {
  auto message = WithJoints<msg::SimTruth>(moment);
  for (std::size_t j = 0; j < message.joint_count; ++j) {
    message.play_angle_rad[j] = 0.5 * kBacklash_rad;
    message.backlash_rad[j] = kBacklash_rad;
  }
  return message;
}

template <auto make>
node::Bytes Encoded(std::string_view topic, const Moment& moment) {
  auto message = make(moment);
  message.header.session_id = topic == moment.foreign ? kForeignSession : moment.session_id;
  message.header.tick = moment.tick;
  message.header.stamp_ns =
      static_cast<std::int64_t>(kNs_s * static_cast<double>(moment.tick) * moment.period_s);
  message.header.origin = topic == moment.replayed ? msg::Origin::kReplay : msg::Origin::kSim;
  node::Bytes bytes;
  if (!node::Encode(message, &bytes)) throw std::logic_error("a played message does not encode");
  return bytes;
}

struct PlayedTopic {
  std::string_view name;
  node::Bytes (*make)(std::string_view topic, const Moment&);
};

// joint_state is the last one: a tick begins when its other messages are there.
constexpr PlayedTopic kPlayed[] = {
    {node::kActuatorState.name, &Encoded<MakeActuatorState>},
    {node::kSimTruth.name, &Encoded<MakeSimTruth>},
    {node::kReference.name, &Encoded<MakeReference>},
    {node::kRegime.name, &Encoded<MakeRegime>},
    {node::kMotionRequest.name, &Encoded<MakeMotionRequest>},
    {node::kTorquePrediction.name, &Encoded<MakeTorquePrediction>},
    {node::kReservoirState.name, &Encoded<MakeReservoirState>},
    {node::kReadout.name, &Encoded<MakeReadout>},
    {node::kAdaptationState.name, &Encoded<MakeAdaptationState>},
    {node::kValveCommand.name, &Encoded<MakeValveCommand>},
    {node::kPneumaticState.name, &Encoded<MakePneumaticState>},
    {node::kJointCommand.name, &Encoded<MakeJointCommand>},
    {node::kJointState.name, &Encoded<MakeJointState>},
};

}  // namespace

std::vector<std::string_view> PlayedTopics() {
  std::vector<std::string_view> names;
  for (const PlayedTopic& topic : kPlayed) names.push_back(topic.name);
  return names;
}

node::Bytes PlayedMessage(std::string_view topic, const Moment& moment) {
  for (const PlayedTopic& played : kPlayed) {
    if (played.name == topic) return played.make(topic, moment);
  }
  throw std::logic_error("no such played topic");
}

}  // namespace sinew::conform

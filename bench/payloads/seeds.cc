#include "bench/payloads/seeds.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/estop.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/log.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/performance.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/recording.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/residual.h>
#include <sinew_idl/sensors.h>
#include <sinew_idl/simulation.h>
#include <sinew_idl/snapshot.h>
#include <sinew_idl/status.h>

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "components/topics/node/topics.h"

namespace sinew::payloads {
namespace {

constexpr double kSeedRate_Hz = 240.0;
constexpr double kAmplitude_rad = 0.05;
constexpr double kGear = 100.0;
constexpr std::size_t kJoints = 12;
constexpr std::uint32_t kAllSignals = 0x7FFF;

struct Motion {
  double position_rad, velocity_rad_s, acceleration_rad_s2;
};

Motion At(std::size_t phase) {
  const double omega_rad_s = 2.0 * std::numbers::pi * kSeedRate_Hz / static_cast<double>(kPhases);
  const double angle =
      2.0 * std::numbers::pi * static_cast<double>(phase) / static_cast<double>(kPhases);
  return {kAmplitude_rad * std::sin(angle), kAmplitude_rad * omega_rad_s * std::cos(angle),
          -kAmplitude_rad * omega_rad_s * omega_rad_s * std::sin(angle)};
}

// Mostly the rig's one joint, sometimes all that a message can hold.
std::uint8_t CountAt(std::size_t phase) { return phase % 16 == 15 ? kJoints : 1; }

template <class Message>
node::Bytes Encoded(const Message& message) {
  node::Bytes bytes;
  if (!node::Encode(message, &bytes)) throw std::logic_error("a seed does not fit its bounds");
  return bytes;
}

msg::JointState StateAt(std::size_t phase, msg::RobotState robot_state) {
  const Motion motion = At(phase);
  msg::JointState state;
  state.header.origin = msg::Origin::kSim;
  state.robot_state = robot_state;
  state.period_s = 1.0 / kSeedRate_Hz;
  state.measured_period_s = 1.0 / kSeedRate_Hz;
  state.joint_count = CountAt(phase);
  state.position_rad.fill(motion.position_rad);
  state.velocity_rad_s.fill(motion.velocity_rad_s);
  state.torque_Nm.fill(0.5 * std::sin(motion.position_rad));
  state.valid.fill(true);
  return state;
}

class Collection {
 public:
  Collection() : seeds_(node::AllTopics().size()) {}

  template <class Message>
  void Add(const node::Topic<Message>& topic, const Message& message) {
    seeds_[IndexOf(topic.name)].push_back(Encoded(message));
  }
  std::vector<std::vector<node::Bytes>> Take() {
    AddEmpty(node::kJointCommand);
    AddEmpty(node::kValveCommand);
    AddEmpty(node::kPneumaticState);
    AddEmpty(node::kRegime);
    AddEmpty(node::kTorquePrediction);
    AddEmpty(node::kReservoirState);
    AddEmpty(node::kAdaptationState);
    AddEmpty(node::kResidual);
    AddEmpty(node::kPerformance);
    AddEmpty(node::kEstopState);
    AddEmpty(node::kReference);
    AddEmpty(node::kCommandSource);
    AddEmpty(node::kFootForce);
    AddEmpty(node::kImu);
    AddEmpty(node::kBusStatus);
    AddEmpty(node::kRecordingProgress);
    AddEmpty(node::kComponentStatus);
    AddEmpty(node::kLog);
    for (const auto& of_topic : seeds_) {
      if (of_topic.empty()) throw std::logic_error("a topic has no seed");
    }
    return std::move(seeds_);
  }

 private:
  template <class Message>
  void AddEmpty(const node::Topic<Message>& topic) {
    if (!seeds_[IndexOf(topic.name)].empty()) return;
    Message message;
    message.header.origin = msg::Origin::kSim;
    Add(topic, message);
  }

  std::vector<std::vector<node::Bytes>> seeds_;
};

msg::ActuatorState ActuatorAt(std::size_t phase) {
  const Motion motion = At(phase);
  msg::ActuatorState state;
  state.header.origin = msg::Origin::kSim;
  state.joint_count = CountAt(phase);
  state.motor_position_rad.fill(kGear * motion.position_rad);
  state.motor_velocity_rad_s.fill(kGear * motion.velocity_rad_s);
  state.motor_current_A.fill(20.0 * motion.position_rad);
  state.drive_voltage_V.fill(5.0 * motion.position_rad);
  state.motor_temperature_degC.fill(25.0);
  state.chamber_pressure_bar.fill(4.0 + motion.position_rad);
  state.reservoir_pressure_bar.fill(4.1);
  state.valve_open.fill(phase % 2 == 0);
  state.valid.fill(true);
  state.measured_flags = kAllSignals;
  return state;
}

void AddRequests(Collection* seeds) {
  for (int action = 0; action <= static_cast<int>(msg::OperatorAction::kPermitReplay); ++action) {
    msg::OperatorCommand command;
    command.header.origin = msg::Origin::kSim;
    command.action = static_cast<msg::OperatorAction>(action);
    command.reason = "payloads";
    command.role = "control";
    command.target = "control";
    seeds->Add(node::kOperatorCommand, command);
  }
  for (std::size_t phase = 0; phase < kPhases; phase += 4) {
    const Motion motion = At(phase);
    msg::MotionRequest request;
    request.header.origin = msg::Origin::kSim;
    request.requester = "payloads";
    request.joint_count = CountAt(phase);
    request.kind.fill(static_cast<msg::MotionKind>(phase / 4 % 4));
    request.target_rad.fill(motion.position_rad);
    request.velocity_limit_rad_s.fill(0.5);
    request.motor_torque_limit_Nm.fill(0.1);
    request.pressure_bar.fill(4.5);
    seeds->Add(node::kMotionRequest, request);

    msg::StiffnessRequest stiffness;
    stiffness.header.origin = msg::Origin::kSim;
    stiffness.joint_count = CountAt(phase);
    stiffness.kind.fill(static_cast<msg::StiffnessKind>(phase / 4 % 3));
    stiffness.pressure_bar.fill(4.0 + motion.position_rad);
    stiffness.stiffness_Nm_rad.fill(20.0);
    seeds->Add(node::kStiffnessRequest, stiffness);
  }
}

void AddSnapshots(Collection* seeds) {
  for (const char* name : {"", "control"}) {
    msg::SnapshotRequest request;
    request.header.origin = msg::Origin::kSim;
    request.name = name;
    request.after_tick = 1;
    seeds->Add(node::kSnapshotRequest, request);
  }
  msg::ComponentSnapshot part;
  part.header.origin = msg::Origin::kSim;
  part.name = "control";
  part.component_kind = "control";
  part.version = 1;
  part.part_count = 2;
  part.content.assign(100, 7);
  seeds->Add(node::kComponentSnapshot, part);
}

void AddSimulation(Collection* seeds) {
  for (std::size_t phase = 0; phase < kPhases; phase += 8) {
    const Motion motion = At(phase);
    msg::SimDisturbance disturbance;
    disturbance.header.origin = msg::Origin::kSim;
    disturbance.joint_count = CountAt(phase);
    disturbance.load_force_N.fill(100.0 * motion.position_rad);
    seeds->Add(node::kSimDisturbance, disturbance);
    msg::SimPressure pressure;
    pressure.header.origin = msg::Origin::kSim;
    pressure.joint_count = CountAt(phase);
    pressure.imposed.fill(phase % 16 == 0);
    pressure.chamber_pressure_bar.fill(4.0);
    seeds->Add(node::kSimPressure, pressure);
    msg::SimTruth truth;
    truth.header.origin = msg::Origin::kSim;
    truth.joint_count = CountAt(phase);
    truth.contact.fill(static_cast<msg::ContactSide>(phase / 8 % 3));
    truth.play_angle_rad.fill(0.02);
    truth.backlash_rad.fill(0.0464);
    seeds->Add(node::kSimTruth, truth);
    msg::SimBodyDisturbance load;
    load.header.origin = msg::Origin::kSim;
    load.payload_link = phase % 16 == 0 ? "pelvis" : "";
    load.payload_kg = 4.0;
    load.payload_m.fill(motion.position_rad);
    load.push_link = "torso";
    load.push_force_N.fill(100.0 * motion.position_rad);
    load.lost_drive = phase % 8 == 0 ? "left_knee" : "";
    load.lost_friction = 0.5;
    seeds->Add(node::kSimBodyDisturbance, load);
    msg::SimBodyTruth body;
    body.header.origin = msg::Origin::kSim;
    body.position_m = {0.0, 0.0, 0.7 + motion.position_rad};
    body.orientation_wxyz = {1.0, 0.0, 0.0, 0.0};
    body.contact_force_N.fill(20.0);
    seeds->Add(node::kSimBodyTruth, body);
  }
}

}  // namespace

std::size_t IndexOf(std::string_view topic) {
  const auto& topics = node::AllTopics();
  for (std::size_t i = 0; i < topics.size(); ++i) {
    if (topics[i].name == topic) return i;
  }
  throw std::logic_error("no topic '" + std::string(topic) + "'");
}

node::Bytes JointStateSeed(std::size_t phase, std::size_t robot_state) {
  return Encoded(StateAt(phase, static_cast<msg::RobotState>(robot_state)));
}

std::size_t LastTickOffset() {
  msg::JointState state = StateAt(0, msg::RobotState::kDisarmed);
  const node::Bytes runs = Encoded(state);
  state.last_tick = true;
  const node::Bytes ends = Encoded(state);
  std::size_t at = 0;
  while (runs[at] == ends[at]) ++at;
  return at;
}

std::vector<std::vector<node::Bytes>> HandmadeSeeds() {
  Collection seeds;
  for (std::size_t phase = 0; phase < kPhases; ++phase) {
    seeds.Add(node::kJointState, StateAt(phase, msg::RobotState::kArmed));
    seeds.Add(node::kActuatorState, ActuatorAt(phase));
  }
  msg::Readout readout;
  readout.header.origin = msg::Origin::kSim;
  readout.output_count = 1;
  readout.feature_count = 4;
  readout.weight.assign(4, 0.1);
  seeds.Add(node::kReadout, readout);
  AddRequests(&seeds);
  AddSnapshots(&seeds);
  AddSimulation(&seeds);
  return seeds.Take();
}

}  // namespace sinew::payloads

// Every topic: its name, type and QoS profile. The same table, for people, is idl/README.md; a test
// compares the two. This header needs no DDS: messages are only declared here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sinew::msg {
class JointState;
class JointCommand;
class ActuatorState;
class FootForce;
class Imu;
class BusStatus;
class ValveCommand;
class PneumaticState;
class StiffnessRequest;
class RegimeState;
class TorquePrediction;
class ReservoirState;
class Readout;
class AdaptationState;
class ResidualState;
class Reference;
class OperatorCommand;
class MotionRequest;
class ComponentStatus;
class SimDisturbance;
class RecordingProgress;
}  // namespace sinew::msg

namespace sinew::node {

// How a topic travels in real time; in lockstep every topic but the latched ones uses `lockstep`.
enum class Profile {
  kState,     // BEST_EFFORT, KEEP_LAST 1: the newest sample is the only one that matters
  kControl,   // as kState, EXCLUSIVE ownership, 20 ms deadline: one writer at a time
  kEvent,     // RELIABLE, KEEP_LAST 16, volatile: requests and arm
  kLatched,   // RELIABLE, TRANSIENT_LOCAL, KEEP_LAST 1 per key: status, readout
  kLog,       // readers of recorders: RELIABLE where offered, KEEP_ALL
  kLockstep,  // RELIABLE, TRANSIENT_LOCAL, KEEP_LAST 256, no wall-clock QoS: nothing dropped
};

std::string_view ProfileName(Profile profile);

template <class Message>
struct Topic {
  std::string_view name;
  Profile profile;
};

inline constexpr Topic<msg::JointState> kJointState{"joint_state", Profile::kState};
inline constexpr Topic<msg::JointCommand> kJointCommand{"joint_command", Profile::kControl};
inline constexpr Topic<msg::ActuatorState> kActuatorState{"actuator_state", Profile::kState};
inline constexpr Topic<msg::FootForce> kFootForce{"foot_force", Profile::kState};
inline constexpr Topic<msg::Imu> kImu{"imu", Profile::kState};
inline constexpr Topic<msg::BusStatus> kBusStatus{"bus_status", Profile::kState};
inline constexpr Topic<msg::ValveCommand> kValveCommand{"valve_command", Profile::kControl};
inline constexpr Topic<msg::PneumaticState> kPneumaticState{"pneumatic_state", Profile::kState};
inline constexpr Topic<msg::StiffnessRequest> kStiffnessRequest{"stiffness_request",
                                                                Profile::kEvent};
inline constexpr Topic<msg::RegimeState> kRegime{"regime", Profile::kState};
inline constexpr Topic<msg::TorquePrediction> kTorquePrediction{"torque_prediction",
                                                                Profile::kState};
inline constexpr Topic<msg::ReservoirState> kReservoirState{"reservoir_state", Profile::kState};
inline constexpr Topic<msg::Readout> kReadout{"readout", Profile::kLatched};
inline constexpr Topic<msg::AdaptationState> kAdaptationState{"adaptation_state", Profile::kState};
inline constexpr Topic<msg::ResidualState> kResidual{"residual", Profile::kState};
inline constexpr Topic<msg::Reference> kReference{"reference", Profile::kState};
inline constexpr Topic<msg::OperatorCommand> kOperatorCommand{"operator_command", Profile::kEvent};
inline constexpr Topic<msg::MotionRequest> kMotionRequest{"motion_request", Profile::kEvent};
inline constexpr Topic<msg::ComponentStatus> kComponentStatus{"component_status",
                                                              Profile::kLatched};
inline constexpr Topic<msg::SimDisturbance> kSimDisturbance{"sim_disturbance", Profile::kEvent};
inline constexpr Topic<msg::RecordingProgress> kRecordingProgress{"recording_progress",
                                                                  Profile::kEvent};

// The table at run time, for recorders, `list` and tests.
struct TopicInfo {
  std::string name;
  std::string type_name;  // "sinew::msg::JointState"
  Profile profile;
  std::string idl;            // flattened text of its type
  std::string idl_hash;       // of that text without comments and blanks, 8 hex digits
  std::string dds_type_name;  // as registered: type_name + "_" + idl_hash, or the plain name
};
const std::vector<TopicInfo>& AllTopics();
const TopicInfo* FindTopic(std::string_view name);  // nullptr: no such topic
std::string AllTopicsHash();

}  // namespace sinew::node

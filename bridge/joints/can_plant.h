// Joints behind CAN as a state provider's plant: commands to frames, frames to sensors, and the
// last line of limits.
//
// A joint is a motor controller (ODrive CANSimple) and, where there is one, a sensor node at its
// output. Output angle q, motor angle m (at the shaft), controller's revolutions r:
//
//     m = direction * 2 pi * (r - zero_rev - home_rev)
//     q = node direction * (angle - zero_rad), or m / gear_ratio
//     torque setpoint = direction * T * controller_torque_constant / torque_constant
//
// so that the current is T / torque_constant whatever the controller was told its constant is.
// Joint torque is told as torque_efficiency * gear_ratio * torque_constant * Iq * direction.
//
// Arming a joint: mode, limits, closed-loop control; neutral setpoints until the heartbeat says
// closed loop; then the commands. In position mode the setpoint leaves the measured position at no
// more than the velocity limit. Every cycle carries a setpoint, so that the controllers' watchdogs
// are fed while the bridge lives.
//
// Through a gateway the cyclic part is the compact exchange (bridge/can/compact.h): position
// setpoints leave as references, estimates and Iq come in states; everything else stays CANSimple.
// References are of 0.01 motor turns. A joint in torque or velocity mode has a setpoint of its own.
//
// Homing by whole turns: a controller that knows its angle within one turn only counts from
// anywhere after power-up. home_rev is the number of whole turns that the output encoder tells at
// the start and at every reset; that is certain while half the play and the tolerance are less than
// half a motor turn. Zero check: at the start and whenever a joint is armed |m / gear_ratio - q|
// must be within half the play and the tolerance, else it is a fault: a wrong zero_rev, a slipped
// magnet, a missing homing.
//
// Limits, whatever is commanded: torque and current; no torque in the direction of motion near the
// velocity limit (tapered over its last tenth), none outwards beyond the position limits. Faults
// are latched until ClearFault: axis error, lost heartbeat, lost estimates, lost sensor node,
// encoder jump, over-temperature, overspeed (1.5 times the limit), too far outside (margin), no
// closed loop, a failed zero check, a setpoint that is not finite. A joint with a fault idles; what
// the others do is the provider's (Rest in guard.h).
//
// One thread. Step allocates only when a fault's message is written.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "bridge/can/codec.h"
#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/transport.h"
#include "bridge/joints/compact_link.h"
#include "components/provider/plant.h"
#include "components/types/control_mode.h"

namespace sinew::bridge {

struct JointLimits {
  double motor_torque_Nm = 0.0;
  double current_A = 0.0;
  double velocity_rad_s = 0.0;  // output
  double lower_rad = 0.0;       // output
  double upper_rad = 0.0;
  double margin_rad = 0.2;  // beyond a position limit by more than this: fault
  double motor_temperature_degC = std::numeric_limits<double>::infinity();
};

struct OutputNode {
  int node = 0;
  int direction = 1;
  double zero_rad = 0.0;
};

// Motor encoder against output encoder.
struct ZeroCheck {
  double play_rad = 0.0;  // full width, output
  double tolerance_rad = 0.0;
};

struct JointConfig {
  std::string name;
  int bus = 0;
  int node = 0;
  can::Firmware firmware = can::Firmware::k0_5_6;
  int direction = 1;
  double gear_ratio = 1.0;
  double zero_rev = 0.0;
  double torque_constant_Nm_A = 0.0;
  double controller_torque_constant_Nm_A = 0.0;
  double torque_efficiency = 1.0;  // of the gear, in the torque that is told
  double declared_payload_kg = 0.0;
  JointLimits limits;
  std::optional<OutputNode> output;
  std::optional<ZeroCheck> zero_check;  // needs the output node
  bool home_by_whole_turns = false;     // needs the zero check
};

// One for the joints of a bus or a part of them; the first one tells feet and IMU, too.
struct GatewayConfig {
  int bus = 0;
  int node = 0;
  std::vector<int> joints;  // in the order of its fields, at most can::kCompactJoints
};

enum class Estimates { kCyclic, kRequested };

struct BridgeTiming {
  Estimates estimates = Estimates::kCyclic;
  // Each joint is asked every so many cycles, the joints of a bus in turn; 0: the controllers send
  // it by themselves.
  int iq_every_cycles = 1;
  double answer_window_s = 0.0015;    // requested estimates are awaited so long within a cycle
  double estimate_timeout_s = 0.02;   // older: the joint is not valid
  double lost_after_s = 0.06;         // older: fault
  double heartbeat_timeout_s = 0.35;  // 10 Hz, three missed
  double closed_loop_timeout_s = 1.0;
  double start_timeout_s = 5.0;
  int valve_timeout_ms = 60;  // of the nodes' own watchdogs
};

struct BridgeConfig {
  bool live = false;  // hardware: only live commands count
  std::vector<JointConfig> joints;
  std::vector<GatewayConfig> gateways;
  std::vector<double> bitrate_bit_s;  // per bus, for the load
  bool short_frames = true;           // setpoints of 4 bytes: 95 bit times instead of 135
  BridgeTiming timing;
};

enum class FaultKind {
  kNone,
  kAxisError,
  kHeartbeatLost,
  kEstimatesLost,
  kNodeLost,
  kEncoderJump,
  kOverTemperature,
  kOverspeed,
  kOutOfRange,
  kNoClosedLoop,
  kZero,
  kNotFinite,
};

class CanPlant : public provider::Plant {
 public:
  // The transports must outlive it. Throws std::invalid_argument naming joint and value.
  CanPlant(const BridgeConfig& config, std::vector<can::Transport*> transports);

  // What the constructor refuses, without a transport.
  static void Check(const BridgeConfig& config);
  // The identifiers a bus's transport has to let through: exactly those.
  static std::vector<can::IdFilter> Filters(const BridgeConfig& config, int bus);

  int joint_count() const override { return static_cast<int>(joints_.size()); }
  bool live() const override { return config_.live; }
  std::uint32_t measured_flags() const override;
  // Clears the controllers' errors, waits until everything has been heard. Throws
  // std::runtime_error naming what stayed silent.
  void Reset(provider::PlantSensors* sensors) override;
  void Step(const provider::PlantCommand& command, double period_s,
            provider::PlantSensors* sensors) override;
  bool acts_at_once() const override { return true; }
  // Sends the cycle's frames; the next Step then only reads. Without it, Step sends them.
  void Act(const provider::PlantCommand& command, double period_s) override;
  const provider::BusReport* bus_report() const override { return &report_; }
  const provider::BodySensors* body_sensors() const override {
    return links_.empty() ? nullptr : &body_;
  }

  // The operator's reset: errors of the controllers cleared, latched faults forgotten. What is
  // still wrong is a fault again at the next Step.
  void ClearFault() override;

  // The last frames of a bridge that ends in order: neutral setpoints, axes idle, relays off.
  void Rest();

  FaultKind fault(int joint) const { return joints_[static_cast<std::size_t>(joint)].fault; }
  std::uint64_t malformed() const { return malformed_; }  // frames of ours that could not be read

 private:
  enum class Phase { kIdle, kArming, kActive };
  struct Joint {
    JointConfig config;
    int turn = 0;      // among the joints of its bus
    int gateway = -1;  // index, or -1
    int field = 0;     // of the gateway
    // Heard.
    std::int64_t heartbeat_ns = 0;
    std::int64_t estimates_ns = 0;
    std::int64_t iq_ns = 0;
    std::int64_t output_ns = 0;
    std::int64_t sensors_ns = 0;
    std::int64_t estimates_asked_ns = 0;  // 0: no answer is awaited
    std::int64_t iq_asked_ns = 0;
    can::Heartbeat heartbeat;
    can::EncoderEstimates estimates;
    double iq_A = 0.0;
    can::OutputEncoder output;
    can::JointSensors node_sensors;
    // Done.
    Phase phase = Phase::kIdle;
    std::int64_t phase_ns = 0;
    std::int64_t told_ns = 0;  // last time the axis was told its state
    types::ControlMode mode = types::ControlMode::kIdle;
    double sent_position_rad = 0.0;
    std::uint8_t valve_sequence = 0;
    std::int64_t cleared_ns = 0;
    bool asked_errors = false;
    std::uint32_t answered = 0;  // bit per command whose error is in fault_text
    double home_rev = 0.0;
    FaultKind fault = FaultKind::kNone;
    bool fault_told = false;  // to the provider: a reset clears only what was
    std::string fault_text;

    double motor_position_rad() const;
    double motor_velocity_rad_s() const;
    double position_rad() const;
    double velocity_rad_s() const;
  };

  void Take(int bus, const can::Received& received);
  void TakeFromAxis(Joint& joint, const can::Received& received);
  void TakeFromNode(Joint& joint, const can::Received& received);
  void TakeFromGateway(std::size_t gateway, const can::Received& received);
  void TakeEstimates(Joint& joint, const can::EncoderEstimates& estimates, std::int64_t stamp_ns);
  bool AsksIq(const Joint& joint) const;
  void Drain();
  void Collect(std::int64_t cycle_start_ns);
  bool AllAnswered(std::int64_t cycle_start_ns) const;

  void CommandJoint(Joint& joint, types::ControlMode mode, double torque_Nm, double position_rad,
                    double velocity_rad_s, double period_s, std::int64_t now_ns);
  void SendSetpoint(Joint& joint, double torque_Nm, double position_rad, double velocity_rad_s,
                    double period_s);
  void SendNeutral(Joint& joint);
  void SendArming(Joint& joint, std::int64_t now_ns);
  void SendIdle(Joint& joint, std::int64_t now_ns);
  void SendMeasuredPosition(const Joint& joint);
  double LimitedTorque(const Joint& joint, double torque_Nm) const;
  double Revolutions(const Joint& joint, double position_rad) const;
  static void Home(Joint& joint);
  void CheckZero(Joint& joint);
  // Frames leave with the next Flush.
  template <class Message>
  void Send(const Joint& joint, const Message& message);
  void Ask(Joint& joint, can::Command command);
  void Answered(int bus, std::int64_t* asked_ns, std::int64_t stamp_ns);
  void Post(int bus, const can::Frame& frame) {
    outbox_[static_cast<std::size_t>(bus)].push_back(frame);
  }
  void PostReferences();
  void Flush();

  void Assess(std::int64_t now_ns);
  void Fail(Joint& joint, FaultKind kind, const char* what);
  static void AppendError(Joint& joint, can::Command command, const char* who, std::uint64_t error);
  void FailSilent(Joint& joint, FaultKind kind, const char* what);  // says so when the bus is down
  void Fill(std::int64_t now_ns, provider::PlantSensors* sensors);
  void FillBody(std::int64_t now_ns);
  void Report(std::int64_t now_ns, double work_us);

  BridgeConfig config_;
  std::vector<can::Transport*> transports_;
  std::vector<Joint> joints_;
  std::vector<std::array<int, 64>> axis_of_;  // per bus and node: joint, or -1
  std::vector<std::array<int, 64>> node_of_;
  std::vector<std::array<int, 64>> gateway_of_;
  std::vector<CompactLink> links_;  // per gateway
  provider::BodySensors body_;
  std::vector<std::vector<can::Frame>> outbox_;  // per bus
  std::uint64_t cycle_ = 0;
  bool acted_ = false;
  double acted_us_ = 0.0;  // work of Act, for the report
  std::uint64_t malformed_ = 0;
  provider::BusReport report_;
  std::int64_t report_ns_ = 0;
  std::array<std::uint64_t, provider::BusReport::kMaxBuses> reported_bits_{};
  // The newest times since they were last told.
  struct Recent {
    std::array<double, 512> values_us{};
    std::size_t count = 0;
    void Add(double value_us) { values_us[count++ % values_us.size()] = value_us; }
    void Tell(double* median_us, double* most_us);  // 0 where there were none
  };
  Recent work_;
  std::vector<Recent> answers_;              // per bus
  std::vector<std::int64_t> references_ns_;  // per gateway: sent, no state since
};

}  // namespace sinew::bridge

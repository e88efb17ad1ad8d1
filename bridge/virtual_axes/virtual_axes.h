// Motor controllers and sensor nodes that exist only as frames, with a simulated plant behind them.
//
// Each axis answers as an ODrive with firmware 0.5.x does
// (Firmware/communication/can/can_simple.cpp, MotorControl/axis.cpp): heartbeat, cyclic and
// requested messages, idle and closed-loop control, errors, limits, watchdog, estop, reboot. Each
// sensor node sends output encoder, pressures, load cell and relays and has a watchdog of its own.
// A gateway takes the references of the compact exchange for the axes behind it and answers the
// last frame of them with a state; all else reaches the axes as it is. A reference moves an axis
// that is in position control and feeds the watchdog of every axis. Forces and IMU are the plant's.
// What moves is a provider::Plant (the surrogate, or a test's), stepped at a fixed period.
//
// The controller's own cascade (position, velocity) is the plant's: gains that arrive over the bus
// are kept and told, not used. Calibration and homing end at once. After Reboot an axis is silent
// for 0.3 s.
//
// Pure but for its transports: time comes from Run's argument. One thread.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bridge/can/codec.h"
#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/transport.h"
#include "components/provider/plant.h"

namespace sinew::virtual_axes {

// Every how many milliseconds a message is sent by itself; 0: only when asked for.
struct AxisRates {
  int heartbeat_ms = 100;
  int encoder_ms = 10;
  int iq_ms = 0;
  int bus_voltage_ms = 0;
  int motor_error_ms = 0;
  int encoder_error_ms = 0;
  int controller_error_ms = 0;
};

struct AxisConfig {
  int bus = 0;    // index into the transports
  int node = 0;   // 0..63
  int joint = 0;  // of the plant
  can::Firmware firmware = can::Firmware::k0_5_6;
  int direction = 1;      // +1: encoder and current count up when the output goes up
  double zero_rev = 0.0;  // encoder reading where the plant's motor angle is 0
  double gear_ratio =
      1.0;  // motor turns per output turn: position and velocity setpoints are the motor's
  double controller_torque_constant_Nm_A =
      8.27 / 600;                           // its setting; ODrive's convention is 8.27/KV
  double torque_constant_Nm_A = 0.0159155;  // of the motor, as the plant takes torques
  double velocity_limit_rev_s = 80.0;
  double current_limit_A = 25.0;
  double watchdog_s = 0.0;  // 0: off
  double bus_voltage_V = 24.0;
  double encoder_counts_rev = 16384.0;
  AxisRates rates;
};

struct SensorNodeConfig {
  int bus = 0;
  int node = 0;
  int joint = 0;
  int direction = 1;
  double zero_rad = 0.0;  // encoder reading at output angle 0
  int encoder_ms = 4;
  int sensors_ms = 4;
  int heartbeat_ms = 100;
};

struct GatewayConfig {
  int bus = 0;
  int node = 0;
  std::vector<int> axes;  // node numbers on its bus, in the order of its fields
};

struct VirtualAxesConfig {
  std::vector<AxisConfig> axes;
  std::vector<GatewayConfig> gateways;
  std::vector<SensorNodeConfig> nodes;
  double step_s = 0.001;  // of the plant; also how often frames are looked at
};

class VirtualAxes {
 public:
  // The plant and the transports must outlive it. Throws std::invalid_argument: a joint the plant
  // has not, a node number used twice on a bus, values out of range.
  VirtualAxes(const VirtualAxesConfig& config, provider::Plant& plant,
              std::vector<can::Transport*> transports);

  // What the constructor refuses, without plant and transports.
  static void Check(const VirtualAxesConfig& config, int joints, int buses);

  // Starts at this time.
  void Start(std::int64_t now_ns);
  // When Run wants to be called next.
  std::int64_t next_ns() const { return next_step_ns_; }
  // Takes what has arrived, moves the plant up to `now_ns`, sends what is due. After a pause longer
  // than 50 ms the plant's time stands still for the rest of it.
  void Run(std::int64_t now_ns);
  // Takes what has arrived and answers requests, without moving anything: to be called between
  // steps.
  void Answer(std::int64_t now_ns);

  // The hand at the end of a joint's link, positive presses down; what is not finite is no hand.
  void SetHand(int joint, double force_N);

  // For tests and for tools that stage failures.
  void SetAxisError(int axis, std::uint32_t error);
  void Silence(int axis, bool silent);
  can::AxisState axis_state(int axis) const;
  std::uint32_t axis_error(int axis) const;
  double input_torque_Nm(int axis) const;  // the last setpoint, as the bus says it
  std::uint64_t frames_taken() const { return frames_taken_; }
  std::uint64_t steps() const { return steps_; }
  const provider::PlantSensors& sensors() const { return sensors_; }
  // What the sensors of the relays are told; tests look at it.
  bool valve_open(int node) const;

 private:
  struct Due {
    int every_ms = 0;
    std::int64_t at_ns = 0;
  };
  struct Axis {
    AxisConfig config;
    can::AxisState state = can::AxisState::kIdle;
    std::uint32_t error = 0;
    std::uint64_t motor_error = 0;
    std::uint32_t encoder_error = 0;
    std::uint32_t controller_error = 0;
    can::ControlMode mode = can::ControlMode::kPosition;
    double input_position_rev = 0.0;
    double input_velocity_rev_s = 0.0;
    double input_torque_Nm = 0.0;
    double velocity_limit_rev_s = 0.0;
    double current_limit_A = 0.0;
    double iq_setpoint_A = 0.0;
    std::int64_t fed_ns = 0;
    std::int64_t silent_until_ns = 0;
    bool silenced = false;
    std::array<Due, 7> due;
  };
  struct Node {
    SensorNodeConfig config;
    can::ValveCommand valves;
    std::int64_t fed_ns = 0;
    bool watchdog_expired = false;
    std::uint8_t sequence = 0;
    std::int64_t started_ns = 0;
    std::array<Due, 3> due;
  };

  struct Gateway {
    GatewayConfig config;
    std::vector<std::size_t> axes;  // indices
    can::CompactReferences references;
    can::CompactState state;  // the last that was sent
  };

  void Take(int bus, const can::Frame& frame, std::int64_t now_ns);
  void TakeReferences(Gateway& gateway, const can::Frame& frame, std::int64_t now_ns);
  void SendState(Gateway& gateway, std::int64_t now_ns);
  void TakeForAxis(Axis& axis, const can::Frame& frame, std::int64_t now_ns);
  void SendDue(std::int64_t now_ns);
  void SendAxis(Axis& axis, can::Command command);
  void SendNode(Node& node, int which, std::int64_t now_ns);
  void CheckWatchdogs(std::int64_t now_ns);
  void CheckSpeed();
  void Fail(Axis& axis, std::uint32_t error);
  void StepPlant();
  double PositionRev(const Axis& axis) const;
  double VelocityRevS(const Axis& axis) const;
  double IqA(const Axis& axis) const;
  void SendOn(int bus, const can::Frame& frame);

  VirtualAxesConfig config_;
  provider::Plant& plant_;
  std::vector<can::Transport*> transports_;
  std::vector<Axis> axes_;
  std::vector<Node> nodes_;
  std::vector<Gateway> gateways_;
  std::int64_t step_ns_ = 0;
  std::int64_t next_step_ns_ = 0;
  provider::PlantCommand command_;
  provider::PlantSensors sensors_;
  std::uint64_t frames_taken_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace sinew::virtual_axes

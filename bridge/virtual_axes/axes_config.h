// Configuration of the virtual axes, sensor nodes, gateways and body nodes, and its check. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bridge/can/body_node.h"
#include "bridge/can/codec.h"
#include "bridge/virtual_axes/false_encoder.h"

namespace sinew::virtual_axes {

// Every how many milliseconds a message is sent by itself; 0: only on request.
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
  // Motor turns per output turn: position and velocity setpoints are the motor's.
  double gear_ratio = 1.0;
  double controller_torque_constant_Nm_A = 8.27 / 600;  // its setting; ODrive's rule: 8.27/KV
  double torque_constant_Nm_A = 0.0159155;              // of the motor, as the plant takes torques
  double velocity_limit_rev_s = 80.0;
  double current_limit_A = 25.0;
  double watchdog_s = 0.0;  // 0: off
  double bus_voltage_V = 24.0;
  double encoder_counts_rev = 16384.0;
  AxisRates rates;
  EncoderFault encoder_fault;  // in revolutions
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
  EncoderFault encoder_fault;  // in radians
};

struct GatewayConfig {
  int bus = 0;
  int node = 0;
  std::vector<int> axes;  // node numbers on its bus, in the order of its fields
};

// A body node that reports what is not so, from a time since the start of the axes on.
enum class BodyFaultKind {
  kNone,
  kFrozen,  // the last sample again and again: its sequence number stands still
  kLost,    // nothing is sent
};

struct BodyFault {
  BodyFaultKind kind = BodyFaultKind::kNone;
  double after_s = 0.0;
};

// A foot or the IMU as a node of its own (bridge/can/body_node.h).
struct BodyNodeConfig {
  int bus = 0;
  int node = 0;
  can::BodyPart part = can::BodyPart::kRightFoot;
  // Mounting of an IMU in the torso: v_torso = R v_housing, R = Rz(yaw) Ry(pitch) Rx(roll).
  std::array<double, 3> mounting_rpy_rad = {};
  int sample_ms = 2;
  int heartbeat_ms = 100;
  BodyFault fault = {};
  // Noise of an IMU, standard deviation of each axis and sample, white and Gaussian; 0: none.
  double force_noise_m_s2 = 0.0;
  double rate_noise_rad_s = 0.0;
};

struct VirtualAxesConfig {
  std::vector<AxisConfig> axes;
  std::vector<GatewayConfig> gateways;
  std::vector<SensorNodeConfig> nodes;
  std::vector<BodyNodeConfig> body_nodes = {};
  double step_s = 0.001;  // of the plant; also how often frames are looked at
  // The plant is held where it starts until all axes have been in closed-loop control for this
  // long: a robot on legs hangs from a hoist until its drives carry it. Once let go it is not held
  // again. Nothing: it moves from the start.
  std::optional<double> hold_start_s = {};
  std::uint64_t seed = 1;  // of the noise
};

// Throws std::invalid_argument: a joint that the plant does not have, a node number used twice on a
// bus, values out of range.
void CheckVirtualAxesConfig(const VirtualAxesConfig& config, int joints, int buses);

}  // namespace sinew::virtual_axes

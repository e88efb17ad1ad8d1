// Frames of a sensor node: the small board at a joint that reads the output encoder, the two
// pressures, the load cell and the motor's thermistor, and drives the three relays. Pure.
//
// Same identifiers as the motor controllers (node * 32 + command), in node numbers of their own, so
// that one kernel filter and one address rule serve both. Little-endian. sinew_nodes.dbc describes
// the same bytes for other tools (for node 32; other nodes are offset by 32 per number).
//
//   0x01 NodeHeartbeat  node -> master, 10 Hz   uptime, error bits, version
//   0x09 OutputEncoder  node -> master, cyclic  angle, velocity, sequence, status
//   0x0A JointSensors   node -> master, cyclic  pressures, load force, motor temperature
//   0x0B ValveCommand   master -> node, cyclic  relays, time-out of the node's own watchdog
//
// Angles are the encoder's: direction and zero are the bridge's matter. A value beyond its field is
// held at the field's end. Any thread; allocates nothing.
#pragma once

#include <cstdint>
#include <optional>

#include "bridge/can/frame.h"

namespace sinew::can {

enum class NodeCommand : std::uint8_t {
  kHeartbeat = 0x01,
  kOutputEncoder = 0x09,
  kJointSensors = 0x0A,
  kValveCommand = 0x0B,
  // Messages of body nodes (body_node.h).
  kFootForces = 0x0C,
  kImuForce = 0x0D,
  kImuRate = 0x0E,
  kImuOrientation = 0x0F,
};

// Bits of NodeHeartbeat::error.
namespace node_error {
inline constexpr std::uint8_t kEncoder = 0x01;
inline constexpr std::uint8_t kPressure = 0x02;
inline constexpr std::uint8_t kLoadCell = 0x04;
inline constexpr std::uint8_t kTemperature = 0x08;
inline constexpr std::uint8_t kFootForce = 0x10;    // a force sensor of a foot
inline constexpr std::uint8_t kInertial = 0x20;     // accelerometer or gyroscope
inline constexpr std::uint8_t kOrientation = 0x40;  // the IMU's estimate of its orientation
}  // namespace node_error

// Version of all our frames. An added frame does not change it, other bytes of an existing one do.
inline constexpr std::uint8_t kNodeFramesVersion = 1;

struct NodeHeartbeat {
  std::uint32_t uptime_ms = 0;
  std::uint8_t error = 0;
  std::uint8_t version = kNodeFramesVersion;
  friend bool operator==(const NodeHeartbeat&, const NodeHeartbeat&) = default;
};

struct OutputEncoder {
  double angle_rad = 0.0;       // steps of 1e-6, +-2147
  double velocity_rad_s = 0.0;  // steps of 0.001, +-32.767
  std::uint8_t sequence = 0;    // counts samples: a repeated one was not measured anew
  bool encoder_valid = false;
  bool pressure_valid = false;
  bool load_valid = false;
  bool valve_open = false;  // state of the relays, read back
  bool compressor_on = false;
  bool vent_open = false;
  bool watchdog_expired = false;  // no ValveCommand in time: relays are in their safe state
  friend bool operator==(const OutputEncoder&, const OutputEncoder&) = default;
};

struct JointSensors {
  double chamber_pressure_bar = 0.0;    // gauge, steps of 0.001, +-32.767
  double reservoir_pressure_bar = 0.0;  // gauge, steps of 0.001, +-32.767
  double load_force_N = 0.0;            // steps of 0.01, +-327.67
  double motor_temperature_degC = 0.0;  // steps of 0.1, +-3276.7
  friend bool operator==(const JointSensors&, const JointSensors&) = default;
};

struct ValveCommand {
  bool valve_open = false;
  bool compressor_on = false;
  bool vent_open = false;
  std::uint8_t sequence = 0;
  std::uint16_t timeout_ms =
      0;  // the node goes to its safe state this long after the last one; 0: never
  friend bool operator==(const ValveCommand&, const ValveCommand&) = default;
};

constexpr std::uint32_t Identifier(int node, NodeCommand command) {
  return static_cast<std::uint32_t>(node) << 5 | static_cast<std::uint32_t>(command);
}

Frame Encode(int node, const NodeHeartbeat& message) noexcept;
Frame Encode(int node, const OutputEncoder& message) noexcept;
Frame Encode(int node, const JointSensors& message) noexcept;
Frame Encode(int node, const ValveCommand& message) noexcept;

// Nothing for a frame that is shorter, remote, extended or of another command.
std::optional<NodeHeartbeat> DecodeNodeHeartbeat(const Frame& frame) noexcept;
std::optional<OutputEncoder> DecodeOutputEncoder(const Frame& frame) noexcept;
std::optional<JointSensors> DecodeJointSensors(const Frame& frame) noexcept;
std::optional<ValveCommand> DecodeValveCommand(const Frame& frame) noexcept;

}  // namespace sinew::can

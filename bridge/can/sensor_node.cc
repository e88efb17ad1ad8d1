#include "bridge/can/sensor_node.h"

#include "bridge/can/bytes.h"
#include "bridge/can/node_frame.h"

namespace sinew::can {
namespace {

constexpr double kAngleStep_rad = 1e-6;
constexpr double kVelocityStep_rad_s = 0.001;
constexpr double kPressureStep_bar = 0.001;
constexpr double kForceStep_N = 0.01;
constexpr double kTemperatureStep_degC = 0.1;
constexpr int kValveLength = 4;

}  // namespace

Frame Encode(int node, const NodeHeartbeat& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kHeartbeat, 8);
  PutInteger(frame, 0, m.uptime_ms);
  frame.data[4] = m.error;
  frame.data[5] = m.version;
  return frame;
}

std::optional<NodeHeartbeat> DecodeNodeHeartbeat(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kHeartbeat, 6)) return std::nullopt;
  return NodeHeartbeat{GetInteger<std::uint32_t>(frame, 0), frame.data[4], frame.data[5]};
}

Frame Encode(int node, const OutputEncoder& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kOutputEncoder, 8);
  PutInteger(frame, 0, Quantise<std::int32_t>(m.angle_rad, kAngleStep_rad));
  PutInteger(frame, 4, Quantise<std::int16_t>(m.velocity_rad_s, kVelocityStep_rad_s));
  frame.data[6] = m.sequence;
  frame.data[7] = static_cast<std::uint8_t>(Bit(m.encoder_valid, 0) | Bit(m.pressure_valid, 1) |
                                            Bit(m.load_valid, 2) | Bit(m.valve_open, 3) |
                                            Bit(m.compressor_on, 4) | Bit(m.vent_open, 5) |
                                            Bit(m.watchdog_expired, 6));
  return frame;
}

std::optional<OutputEncoder> DecodeOutputEncoder(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kOutputEncoder, 8)) return std::nullopt;
  OutputEncoder m;
  m.angle_rad = kAngleStep_rad * GetInteger<std::int32_t>(frame, 0);
  m.velocity_rad_s = kVelocityStep_rad_s * GetInteger<std::int16_t>(frame, 4);
  m.sequence = frame.data[6];
  const std::uint8_t bits = frame.data[7];
  m.encoder_valid = Bit(bits, 0);
  m.pressure_valid = Bit(bits, 1);
  m.load_valid = Bit(bits, 2);
  m.valve_open = Bit(bits, 3);
  m.compressor_on = Bit(bits, 4);
  m.vent_open = Bit(bits, 5);
  m.watchdog_expired = Bit(bits, 6);
  return m;
}

Frame Encode(int node, const JointSensors& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kJointSensors, 8);
  PutInteger(frame, 0, Quantise<std::int16_t>(m.chamber_pressure_bar, kPressureStep_bar));
  PutInteger(frame, 2, Quantise<std::int16_t>(m.reservoir_pressure_bar, kPressureStep_bar));
  PutInteger(frame, 4, Quantise<std::int16_t>(m.load_force_N, kForceStep_N));
  PutInteger(frame, 6, Quantise<std::int16_t>(m.motor_temperature_degC, kTemperatureStep_degC));
  return frame;
}

std::optional<JointSensors> DecodeJointSensors(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kJointSensors, 8)) return std::nullopt;
  return JointSensors{kPressureStep_bar * GetInteger<std::int16_t>(frame, 0),
                      kPressureStep_bar * GetInteger<std::int16_t>(frame, 2),
                      kForceStep_N * GetInteger<std::int16_t>(frame, 4),
                      kTemperatureStep_degC * GetInteger<std::int16_t>(frame, 6)};
}

Frame Encode(int node, const ValveCommand& m) noexcept {
  Frame frame = MakeNodeFrame(node, NodeCommand::kValveCommand, kValveLength);
  frame.data[0] = static_cast<std::uint8_t>(Bit(m.valve_open, 0) | Bit(m.compressor_on, 1) |
                                            Bit(m.vent_open, 2));
  frame.data[1] = m.sequence;
  PutInteger(frame, 2, m.timeout_ms);
  return frame;
}

std::optional<ValveCommand> DecodeValveCommand(const Frame& frame) noexcept {
  if (!IsNodeFrame(frame, NodeCommand::kValveCommand, kValveLength)) return std::nullopt;
  ValveCommand m;
  m.valve_open = Bit(frame.data[0], 0);
  m.compressor_on = Bit(frame.data[0], 1);
  m.vent_open = Bit(frame.data[0], 2);
  m.sequence = frame.data[1];
  m.timeout_ms = GetInteger<std::uint16_t>(frame, 2);
  return m;
}

}  // namespace sinew::can

#include "bridge/virtual_axes/sensor_node_model.h"

namespace sinew::virtual_axes {

SensorNodeModel::SensorNodeModel(const SensorNodeConfig& config)
    : config_(config),
      false_encoder_(config.encoder_fault),
      heartbeat_(config.heartbeat_ms),
      encoder_(config.encoder_ms),
      sensors_(config.sensors_ms) {}

void SensorNodeModel::Start(std::int64_t now_ns, std::int64_t spread_ns) {
  started_ns_ = fed_ns_ = now_ns;
  for (Schedule* schedule : {&heartbeat_, &encoder_, &sensors_}) {
    schedule->Start(now_ns, spread_ns);
  }
}

void SensorNodeModel::Take(const can::Frame& frame, std::int64_t now_ns) {
  const auto valves = can::DecodeValveCommand(frame);
  if (!valves) return;
  valves_ = *valves;
  fed_ns_ = now_ns;
  watchdog_expired_ = false;
}

DueFrames<SensorNodeModel::kCyclicMessages> SensorNodeModel::Due(
    const provider::PlantSensors& sensors, const provider::PlantCommand& command,
    std::int64_t now_ns) {
  const auto j = static_cast<std::size_t>(config_.joint);
  DueFrames<kCyclicMessages> due;
  if (heartbeat_.IsDue(now_ns)) {
    const auto uptime_ms = static_cast<std::uint32_t>((now_ns - started_ns_) / kMs_ns);
    due.Add(can::Encode(config_.node, can::NodeHeartbeat{uptime_ms, 0, 1}));
  }
  if (encoder_.IsDue(now_ns)) due.Add(can::Encode(config_.node, Output(sensors, command, now_ns)));
  if (sensors_.IsDue(now_ns)) {
    due.Add(can::Encode(
        config_.node,
        can::JointSensors{sensors.chamber_pressure_bar[j], sensors.reservoir_pressure_bar[j],
                          sensors.load_force_N[j], sensors.motor_temperature_degC[j]}));
  }
  return due;
}

can::OutputEncoder SensorNodeModel::Output(const provider::PlantSensors& sensors,
                                           const provider::PlantCommand& command,
                                           std::int64_t now_ns) {
  const auto j = static_cast<std::size_t>(config_.joint);
  can::OutputEncoder m;
  const FalseEncoder::Reading reading =
      false_encoder_.Of({config_.direction * sensors.position_rad[j] + config_.zero_rad,
                         config_.direction * sensors.velocity_rad_s[j]},
                        1e-9 * static_cast<double>(now_ns - started_ns_));
  m.angle_rad = reading.position;
  m.velocity_rad_s = reading.velocity;
  m.sequence = sequence_++;
  m.encoder_valid = m.pressure_valid = m.load_valid = sensors.valid[j];
  m.valve_open = sensors.valve_open[j];
  m.compressor_on = command.compressor_on[j];
  m.vent_open = command.vent_open[j];
  m.watchdog_expired = watchdog_expired_;
  return m;
}

void SensorNodeModel::CheckWatchdog(std::int64_t now_ns) {
  if (valves_.timeout_ms == 0 || now_ns - fed_ns_ <= valves_.timeout_ms * kMs_ns) return;
  watchdog_expired_ = true;
  valves_ = can::ValveCommand{};
}

void SensorNodeModel::Drive(provider::PlantCommand* command) const {
  const auto j = static_cast<std::size_t>(config_.joint);
  command->valve_open[j] = valves_.valve_open;
  command->compressor_on[j] = valves_.compressor_on;
  command->vent_open[j] = valves_.vent_open;
}

}  // namespace sinew::virtual_axes

// One sensor node that exists only as frames (bridge/can/sensor_node.h): it sends heartbeat, output
// encoder and joint sensors cyclically, and has the three relays, which go off when no ValveCommand
// comes within the time-out of the last one.
//
// Pure: frames, the plant's sensors and the time come in. One thread; allocates nothing.
#pragma once

#include <cstdint>

#include "bridge/can/sensor_node.h"
#include "bridge/virtual_axes/axes_config.h"
#include "bridge/virtual_axes/schedule.h"
#include "components/robot/provider/plant.h"

namespace sinew::virtual_axes {

class SensorNodeModel {
 public:
  static constexpr std::size_t kCyclicMessages = 3;

  explicit SensorNodeModel(const SensorNodeConfig& config);

  int bus() const { return config_.bus; }
  int node() const { return config_.node; }

  void Start(std::int64_t now_ns, std::int64_t spread_ns);
  void Take(const can::Frame& frame, std::int64_t now_ns);
  // The cyclic messages of this time. `command` is the plant's last one: the relays read back.
  DueFrames<kCyclicMessages> Due(const provider::PlantSensors& sensors,
                                 const provider::PlantCommand& command, std::int64_t now_ns);
  void CheckWatchdog(std::int64_t now_ns);
  // The relays of its joint.
  void Drive(provider::PlantCommand* command) const;

  // For tests and for tools that stage failures.
  void Falsify(const EncoderFault& fault) { false_encoder_.Plant(fault); }

  bool valve_open() const { return valves_.valve_open; }

 private:
  can::OutputEncoder Output(const provider::PlantSensors& sensors,
                            const provider::PlantCommand& command, std::int64_t now_ns);

  SensorNodeConfig config_;
  FalseEncoder false_encoder_;
  can::ValveCommand valves_;
  std::int64_t fed_ns_ = 0;
  bool watchdog_expired_ = false;
  std::uint8_t sequence_ = 0;
  std::int64_t started_ns_ = 0;
  Schedule heartbeat_, encoder_, sensors_;
};

}  // namespace sinew::virtual_axes

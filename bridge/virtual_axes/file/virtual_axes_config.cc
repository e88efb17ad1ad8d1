#include "bridge/virtual_axes/file/virtual_axes_config.h"

#include <algorithm>

#include "components/base/types/joints.h"

namespace sinew::virtual_axes {
namespace {

int ReadDirection(const config::Section& section) {
  const auto direction = section.IntegerOr("direction", 1, {-1, 1});
  if (direction == 0) section.Fail("direction", "is 0, expected 1 or -1");
  return static_cast<int>(direction);
}

int ReadPeriod(const config::Section& section, const char* key, int fallback_ms) {
  return static_cast<int>(section.IntegerOr(key, fallback_ms, {0, 60000}));
}

// `encoder_fault: {kind, after_s, size_...}`; `size_key` has the encoder's unit.
EncoderFault ReadEncoderFault(const config::Section& section, const char* size_key) {
  EncoderFault fault;
  if (!section.Has("encoder_fault")) return fault;
  const config::Section given = section.Child("encoder_fault");
  const std::string kind = given.Choice("kind", {"frozen", "offset", "scaled"});
  fault.after_s = given.NumberOr("after_s", 0.0, config::kNotNegative);
  if (kind == "frozen") {
    fault.kind = EncoderFaultKind::kFrozen;
  } else if (kind == "offset") {
    fault.kind = EncoderFaultKind::kOffset;
    fault.size = given.Number(size_key);
  } else {
    fault.kind = EncoderFaultKind::kScaled;
    fault.size = given.Number("share");
  }
  given.RejectUnknownKeys();
  return fault;
}

AxisConfig ReadAxis(const config::Section& section, const std::vector<can::BusEntry>& buses) {
  AxisConfig axis;
  axis.bus = can::ReadBusOf(section, buses);
  axis.node = static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
  axis.joint = static_cast<int>(section.IntegerOr("joint", 0, {0, types::kMaxJoints - 1}));
  axis.firmware = can::ReadFirmware(section);
  axis.direction = ReadDirection(section);
  axis.zero_rev = section.NumberOr("zero_rev", axis.zero_rev);
  axis.gear_ratio = section.Number("gear_ratio", config::kPositive);
  axis.torque_constant_Nm_A =
      section.NumberOr("torque_constant_Nm_A", axis.torque_constant_Nm_A, config::kPositive);
  axis.controller_torque_constant_Nm_A = section.NumberOr(
      "controller_torque_constant_Nm_A", axis.controller_torque_constant_Nm_A, config::kPositive);
  axis.velocity_limit_rev_s =
      section.NumberOr("velocity_limit_rev_s", axis.velocity_limit_rev_s, config::kPositive);
  axis.current_limit_A =
      section.NumberOr("current_limit_A", axis.current_limit_A, config::kPositive);
  axis.watchdog_s = 1e-3 * section.NumberOr("watchdog_ms", 0.0, config::kNotNegative);
  axis.bus_voltage_V = section.NumberOr("bus_voltage_V", axis.bus_voltage_V, config::kPositive);
  AxisRates& rates = axis.rates;
  rates.heartbeat_ms = ReadPeriod(section, "heartbeat_ms", rates.heartbeat_ms);
  rates.encoder_ms = ReadPeriod(section, "encoder_ms", rates.encoder_ms);
  rates.iq_ms = ReadPeriod(section, "iq_ms", rates.iq_ms);
  rates.bus_voltage_ms = ReadPeriod(section, "bus_voltage_ms", rates.bus_voltage_ms);
  axis.encoder_fault = ReadEncoderFault(section, "size_rev");
  section.RejectUnknownKeys();
  return axis;
}

SensorNodeConfig ReadNode(const config::Section& section, const std::vector<can::BusEntry>& buses) {
  SensorNodeConfig node;
  node.bus = can::ReadBusOf(section, buses);
  node.node = static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
  node.joint = static_cast<int>(section.IntegerOr("joint", 0, {0, types::kMaxJoints - 1}));
  node.direction = ReadDirection(section);
  node.zero_rad = section.NumberOr("zero_rad", 0.0);
  node.encoder_ms = ReadPeriod(section, "encoder_ms", node.encoder_ms);
  node.sensors_ms = ReadPeriod(section, "sensors_ms", node.sensors_ms);
  node.heartbeat_ms = ReadPeriod(section, "heartbeat_ms", node.heartbeat_ms);
  node.encoder_fault = ReadEncoderFault(section, "size_rad");
  section.RejectUnknownKeys();
  return node;
}

BodyNodeConfig ReadBodyNode(const config::Section& section,
                            const std::vector<can::BusEntry>& buses) {
  BodyNodeConfig node;
  node.bus = can::ReadBusOf(section, buses);
  node.node = static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
  node.part = can::ReadBodyPart(section);
  if (node.part == can::BodyPart::kImu) {
    node.mounting_rpy_rad = can::ReadMounting(section);
    node.force_noise_m_s2 = section.NumberOr("force_noise_m_s2", 0.0, config::kNotNegative);
    node.rate_noise_rad_s = section.NumberOr("rate_noise_rad_s", 0.0, config::kNotNegative);
  }
  node.sample_ms = ReadPeriod(section, "sample_ms", node.sample_ms);
  node.heartbeat_ms = ReadPeriod(section, "heartbeat_ms", node.heartbeat_ms);
  if (section.Has("fault")) {
    const config::Section fault = section.Child("fault");
    node.fault.kind = fault.Choice("kind", {"frozen", "lost"}) == "frozen" ? BodyFaultKind::kFrozen
                                                                           : BodyFaultKind::kLost;
    node.fault.after_s = fault.NumberOr("after_s", 0.0, config::kNotNegative);
    fault.RejectUnknownKeys();
  }
  section.RejectUnknownKeys();
  return node;
}

GatewayConfig ReadGateway(const config::Section& section, const std::vector<can::BusEntry>& buses) {
  GatewayConfig gateway;
  gateway.bus = can::ReadBusOf(section, buses);
  gateway.node = static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
  for (const std::int64_t node : section.Integers("axes", {0, can::kMaxNode})) {
    gateway.axes.push_back(static_cast<int>(node));
  }
  section.RejectUnknownKeys();
  return gateway;
}

}  // namespace

VirtualAxesFile ReadVirtualAxes(const config::Section& section) {
  VirtualAxesFile file;
  file.buses = can::ReadBuses(section);
  for (const config::Section& axis : section.List("axes"))
    file.axes.axes.push_back(ReadAxis(axis, file.buses));
  for (const config::Section& node : section.ListOrEmpty("sensor_nodes")) {
    file.axes.nodes.push_back(ReadNode(node, file.buses));
  }
  for (const config::Section& gateway : section.ListOrEmpty("gateways")) {
    file.axes.gateways.push_back(ReadGateway(gateway, file.buses));
  }
  for (const config::Section& node : section.ListOrEmpty("body_nodes")) {
    file.axes.body_nodes.push_back(ReadBodyNode(node, file.buses));
  }
  file.axes.step_s = 1e-3 * section.NumberOr("step_ms", 1.0, {0.01, 100.0});
  if (section.Has("hold_start_s")) {
    file.axes.hold_start_s = section.Number("hold_start_s", config::kNotNegative);
  }
  for (const AxisConfig& axis : file.axes.axes) file.joints = std::max(file.joints, axis.joint + 1);
  for (const SensorNodeConfig& node : file.axes.nodes) {
    file.joints = std::max(file.joints, node.joint + 1);
  }
  if (section.Has("world")) {
    if (section.Has("surrogate")) section.Fail("world", "and surrogate, expected one of them");
    file.world_path = section.ExistingPath("world");
  }
  if (section.Has("surrogate")) file.surrogate_path = section.ExistingPath("surrogate");
  section.RejectUnknownKeys();
  return file;
}

std::vector<can::IdFilter> Filters(const VirtualAxesConfig& config, int bus) {
  std::vector<can::IdFilter> filters;
  const auto add = [&](int on, int node) {
    if (on == bus) {
      filters.push_back({static_cast<std::uint32_t>(node) << can::kCommandBits,
                         can::kMaxStandardId & ~((1U << can::kCommandBits) - 1), false});
    }
  };
  for (const AxisConfig& axis : config.axes) add(axis.bus, axis.node);
  for (const SensorNodeConfig& node : config.nodes) add(node.bus, node.node);
  for (const GatewayConfig& gateway : config.gateways) add(gateway.bus, gateway.node);
  return filters;
}

}  // namespace sinew::virtual_axes

#include "bridge/joints/file/bridge_config.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "components/base/types/joints.h"

namespace sinew::bridge {
namespace {

int ReadDirection(const config::Section& section) {
  const auto direction = section.IntegerOr("direction", 1, {-1, 1});
  if (direction == 0) section.Fail("direction", "is 0, expected 1 or -1");
  return static_cast<int>(direction);
}

int ReadNode(const config::Section& section) {
  return static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
}

Braking ReadBraking(const config::Section& section) {
  Braking braking;
  braking.reflected_inertia_kg_m2 = section.Number("reflected_inertia_kg_m2", config::kPositive);
  braking.max_inertia_kg_m2 = section.Number("max_inertia_kg_m2", config::kPositive);
  braking.load_torque_Nm = section.Number("load_torque_Nm", config::kNotNegative);
  braking.command_delay_s =
      1e-3 *
      section.NumberOr("command_delay_ms", 1e3 * braking.command_delay_s, config::kNotNegative);
  section.RejectUnknownKeys();
  return braking;
}

JointLimits ReadLimits(const config::Section& section) {
  JointLimits limits;
  limits.motor_torque_Nm = section.Number("motor_torque_Nm", config::kPositive);
  limits.current_A = section.Number("current_A", config::kPositive);
  limits.velocity_rad_s = section.Number("velocity_rad_s", config::kPositive);
  limits.lower_rad = section.Number("lower_rad");
  limits.upper_rad = section.Number("upper_rad");
  if (limits.lower_rad >= limits.upper_rad) section.Fail("upper_rad", "is not above lower_rad");
  limits.margin_rad = section.NumberOr("margin_rad", limits.margin_rad, config::kNotNegative);
  if (section.Has("motor_temperature_degC")) {
    limits.motor_temperature_degC = section.Number("motor_temperature_degC");
  }
  if (section.Has("braking")) limits.braking = ReadBraking(section.Child("braking"));
  section.RejectUnknownKeys();
  return limits;
}

// As odrivetool prints it: hexadecimal, with or without 0x.
std::string ReadSerialNumber(const config::Section& section) {
  if (!section.Has("serial_number")) return "";
  const std::string text = section.Text("serial_number");
  std::string digits = text.starts_with("0x") || text.starts_with("0X") ? text.substr(2) : text;
  for (char& c : digits) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const bool is_hex = std::all_of(digits.begin(), digits.end(),
                                  [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (digits.empty() || digits.size() > 16 || !is_hex) {
    section.Fail("serial_number",
                 "is '" + text + "', expected hexadecimal digits such as 3861324D3037");
  }
  return digits;
}

JointConfig ReadJoint(const config::Section& section, const std::vector<can::BusEntry>& buses) {
  JointConfig joint;
  joint.name = section.Text("name");
  joint.bus = can::ReadBusOf(section, buses);
  joint.node = ReadNode(section);
  joint.firmware = can::ReadFirmware(section);
  joint.serial_number = ReadSerialNumber(section);
  joint.direction = ReadDirection(section);
  joint.gear_ratio = section.Number("gear_ratio", config::kPositive);
  joint.zero_rev = section.NumberOr("zero_rev", 0.0);
  joint.torque_constant_Nm_A = section.Number("torque_constant_Nm_A", config::kPositive);
  joint.controller_torque_constant_Nm_A =
      section.Number("controller_torque_constant_Nm_A", config::kPositive);
  joint.torque_efficiency = section.NumberOr("torque_efficiency", 1.0, {1e-3, 1.0});
  joint.declared_payload_kg = section.NumberOr("declared_payload_kg", 0.0, config::kNotNegative);
  joint.limits = ReadLimits(section.Child("limits"));
  if (section.Has("sensor_node")) {
    const config::Section node = section.Child("sensor_node");
    joint.output = OutputNode{ReadNode(node), ReadDirection(node), node.NumberOr("zero_rad", 0.0)};
    node.RejectUnknownKeys();
  }
  if (section.Has("zero_check")) {
    const config::Section check = section.Child("zero_check");
    joint.zero_check = ZeroCheck{check.Number("play_rad", config::kNotNegative),
                                 check.Number("tolerance_rad", config::kPositive)};
    check.RejectUnknownKeys();
  }
  joint.compliance_rad =
      section.NumberOr("compliance_rad", joint.compliance_rad, config::kNotNegative);
  joint.home_by_whole_turns =
      section.ChoiceOr("homing", "none", {"none", "whole_turns"}) == "whole_turns";
  section.RejectUnknownKeys();
  return joint;
}

GatewayConfig ReadGateway(const config::Section& section, const std::vector<can::BusEntry>& buses,
                          const std::vector<JointConfig>& joints) {
  GatewayConfig gateway;
  gateway.bus = can::ReadBusOf(section, buses);
  gateway.node = ReadNode(section);
  for (const std::string& name : section.TextsOr("joints", {})) {
    const auto joint = std::find_if(joints.begin(), joints.end(),
                                    [&](const JointConfig& j) { return j.name == name; });
    if (joint == joints.end())
      section.Fail("joints", "has '" + name + "', which is no joint's name");
    gateway.joints.push_back(static_cast<int>(joint - joints.begin()));
  }
  const std::vector<std::string> carried = section.TextsOr("body", {"feet", "imu"});
  gateway.carries_feet = gateway.carries_imu = false;
  for (const std::string& sensor : carried) {
    if (sensor != "feet" && sensor != "imu") {
      section.Fail("body", "has '" + sensor + "', expected feet or imu");
    }
    (sensor == "feet" ? gateway.carries_feet : gateway.carries_imu) = true;
  }
  section.RejectUnknownKeys();
  return gateway;
}

BodyNodeConfig ReadBodyNode(const config::Section& section,
                            const std::vector<can::BusEntry>& buses) {
  BodyNodeConfig node;
  node.bus = can::ReadBusOf(section, buses);
  node.node = ReadNode(section);
  node.part = can::ReadBodyPart(section);
  if (node.part == can::BodyPart::kImu) node.mounting_rpy_rad = can::ReadMounting(section);
  section.RejectUnknownKeys();
  return node;
}

BridgeTiming ReadTiming(const config::Section& section) {
  BridgeTiming timing;
  timing.estimates = section.ChoiceOr("estimates", "cyclic", {"cyclic", "requested"}) == "requested"
                         ? Estimates::kRequested
                         : Estimates::kCyclic;
  const auto seconds = [&section](const char* key, double fallback_s) {
    return 1e-3 * section.NumberOr(key, 1e3 * fallback_s, config::kPositive);
  };
  timing.iq_every_cycles =
      static_cast<int>(section.IntegerOr("iq_every_cycles", timing.iq_every_cycles, {0, 1000}));
  timing.answer_window_s = seconds("answer_window_ms", timing.answer_window_s);
  timing.estimate_timeout_s = seconds("estimate_timeout_ms", timing.estimate_timeout_s);
  timing.lost_after_s = seconds("lost_after_ms", timing.lost_after_s);
  timing.heartbeat_timeout_s = seconds("heartbeat_timeout_ms", timing.heartbeat_timeout_s);
  timing.closed_loop_timeout_s = seconds("closed_loop_timeout_ms", timing.closed_loop_timeout_s);
  timing.start_timeout_s = seconds("start_timeout_ms", timing.start_timeout_s);
  timing.valve_timeout_ms =
      static_cast<int>(section.IntegerOr("valve_timeout_ms", timing.valve_timeout_ms, {1, 60000}));
  section.RejectUnknownKeys();
  return timing;
}

}  // namespace

BridgeFile ReadBridge(const config::Section& section) {
  BridgeFile file;
  file.buses = can::ReadBuses(section);
  file.bridge.live = section.Choice("origin", {"live", "sim"}) == "live";
  for (const can::BusEntry& bus : file.buses) {
    if (file.bridge.live && bus.kind != can::TransportKind::kSocketCan) {
      section.Fail("origin", "is live, but bus '" + bus.name + "' is no hardware; expected sim");
    }
    if (!file.bridge.live && can::IsHardware(bus)) {
      section.Fail("origin", "is sim, but bus '" + bus.name + "' is the CAN controller " +
                                 bus.interface + ": motors may be behind it; expected live");
    }
    file.bridge.bitrate_bit_s.push_back(bus.bitrate_bit_s);
  }
  file.bridge.short_frames = section.BoolOr("short_frames", true);
  for (const config::Section& joint : section.List("joints")) {
    file.bridge.joints.push_back(ReadJoint(joint, file.buses));
  }
  if (file.bridge.joints.empty() ||
      file.bridge.joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    section.Fail("joints", "has " + std::to_string(file.bridge.joints.size()) +
                               " entries, expected 1 to " + std::to_string(types::kMaxJoints));
  }
  for (const config::Section& gateway : section.ListOrEmpty("gateways")) {
    file.bridge.gateways.push_back(ReadGateway(gateway, file.buses, file.bridge.joints));
  }
  for (const config::Section& node : section.ListOrEmpty("body_nodes")) {
    file.bridge.body_nodes.push_back(ReadBodyNode(node, file.buses));
  }
  file.bridge.timing = ReadTiming(section.ChildOrEmpty("timing"));
  try {
    CheckBridgeConfig(file.bridge);
  } catch (const std::invalid_argument& error) {
    section.Fail("joints", error.what());
  }
  return file;
}

}  // namespace sinew::bridge

#include "bridge/joints/file/bridge_config.h"

#include <algorithm>
#include <cctype>

#include "components/base/types/joints.h"

namespace sinew::bridge {
using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, Braking& c) {
  f.Need("reflected_inertia_kg_m2", c.reflected_inertia_kg_m2, kPositive, "motor, at the output");
  f.Need("max_inertia_kg_m2", c.max_inertia_kg_m2, kPositive, "with the largest load");
  f.Need("load_torque_Nm", c.load_torque_Nm, kNotNegative, "largest of gravity and springs");
  f.Milliseconds("command_delay_ms", c.command_delay_s, kNotNegative, "until a command acts");
}

static void Describe(config::Fields& f, JointLimits& c) {
  f.Need("motor_torque_Nm", c.motor_torque_Nm, kPositive, "at the motor shaft");
  f.Need("current_A", c.current_A, kPositive, "of the motor");
  f.Need("velocity_rad_s", c.velocity_rad_s, kPositive, "of the output");
  f.Need("lower_rad", c.lower_rad, "of the output");
  f.Need("upper_rad", c.upper_rad, "of the output");
  f("margin_rad", c.margin_rad, kNotNegative, "beyond the limits: a fault of the joint");
  f("motor_temperature_degC", c.motor_temperature_degC, "hotter: a fault; left out: none");
  f("braking", c.braking, "before a position limit; left out: nothing brakes");
  f.Require(c.lower_rad < c.upper_rad, "upper_rad", "is not above lower_rad");
}

// As odrivetool prints it: hexadecimal, with or without 0x.
static void DescribeSerialNumber(config::Fields& f, std::string& digits) {
  std::optional<std::string> given;
  f("serial_number", given, "of the controller, as odrivetool prints it");
  if (!given) return;
  digits = given->starts_with("0x") || given->starts_with("0X") ? given->substr(2) : *given;
  for (char& c : digits) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  const bool is_hex = std::all_of(digits.begin(), digits.end(),
                                  [](unsigned char c) { return std::isxdigit(c) != 0; });
  if (digits.empty() || digits.size() > 16 || !is_hex) {
    f.Fail("serial_number",
           "is '" + *given + "', expected hexadecimal digits such as 3861324D3037");
  }
}

static void DescribeJoint(config::Fields& f, JointConfig& c,
                          const std::vector<can::BusEntry>& buses) {
  f.Need("name", c.name, "as in the topics");
  can::DescribeAddress(f, buses, &c.bus, &c.node);
  can::DescribeFirmware(f, c.firmware);
  DescribeSerialNumber(f, c.serial_number);
  can::DescribeDirection(f, c.direction);
  f.Need("gear_ratio", c.gear_ratio, kPositive, "motor turns per output turn");
  f("zero_rev", c.zero_rev, "motor position where the joint is at 0");
  f.Need("torque_constant_Nm_A", c.torque_constant_Nm_A, kPositive, "of the motor");
  f.Need("controller_torque_constant_Nm_A", c.controller_torque_constant_Nm_A, kPositive,
         "that the controller is set to");
  f("torque_efficiency", c.torque_efficiency, {1e-3, 1.0}, "of the torque from the current");
  f("declared_payload_kg", c.declared_payload_kg, kNotNegative, "what the operator declares");
  f.Need("limits", c.limits, "of the joint");
  f.If("sensor_node", "an output encoder", [&c](config::Fields& g) {
    OutputNode& node = c.output.emplace();
    g.Need("node", node.node, {0, can::kMaxNode}, "on the bus");
    can::DescribeDirection(g, node.direction);
    g("zero_rad", node.zero_rad, "its reading where the joint is at 0");
  });
  f.If("zero_check", "both encoders at start", [&c](config::Fields& g) {
    ZeroCheck& check = c.zero_check.emplace();
    g.Need("play_rad", check.play_rad, kNotNegative, "of the gear");
    g.Need("tolerance_rad", check.tolerance_rad, kPositive, "more than the play");
  });
  f("compliance_rad", c.compliance_rad, kNotNegative, "between the encoders");
  f.Word("homing", c.home_by_whole_turns, {{"none", false}, {"whole_turns", true}},
         "the motor's turn by the output encoder");
}

static void DescribeGateway(config::Fields& f, GatewayConfig& c, const BridgeFile& file) {
  std::vector<std::string> joints, body = {"feet", "imu"};
  can::DescribeAddress(f, file.buses, &c.bus, &c.node);
  f("joints", joints, "whose axes it holds when they are not heard");
  for (const std::string& name : joints) {
    const auto& all = file.bridge.joints;
    const auto joint =
        std::find_if(all.begin(), all.end(), [&](const JointConfig& j) { return j.name == name; });
    if (joint == all.end()) f.Fail("joints", "has '" + name + "', which is no joint's name");
    c.joints.push_back(static_cast<int>(joint - all.begin()));
  }
  f("body", body, "what passes it, of feet and imu");
  c.carries_feet = c.carries_imu = false;
  for (const std::string& sensor : body) {
    if (sensor != "feet" && sensor != "imu") {
      f.Fail("body", "has '" + sensor + "', expected feet or imu");
    }
    (sensor == "feet" ? c.carries_feet : c.carries_imu) = true;
  }
}

static void Describe(config::Fields& f, BridgeTiming& c) {
  f.Word("estimates", c.estimates,
         {{"cyclic", Estimates::kCyclic}, {"requested", Estimates::kRequested}},
         "sent by the axes, or asked for");
  f("iq_every_cycles", c.iq_every_cycles, {0, 1000}, "the current is asked for; 0: never");
  f.Milliseconds("answer_window_ms", c.answer_window_s, kPositive, "for answers of a cycle");
  f.Milliseconds("estimate_timeout_ms", c.estimate_timeout_s, kPositive, "older: not valid");
  f.Milliseconds("lost_after_ms", c.lost_after_s, kPositive, "without an estimate: a fault");
  f.Milliseconds("heartbeat_timeout_ms", c.heartbeat_timeout_s, kPositive, "without one: a fault");
  f.Milliseconds("closed_loop_timeout_ms", c.closed_loop_timeout_s, kPositive, "for arming");
  f.Milliseconds("start_timeout_ms", c.start_timeout_s, kPositive, "for all axes to be heard");
  f("valve_timeout_ms", c.valve_timeout_ms, {1, 60000}, "a node without commands shuts its valve");
}

// A live robot has hardware, all of it.
static void CheckOrigin(const config::Fields& f, const BridgeFile& file) {
  for (const can::BusEntry& bus : file.buses) {
    if (file.bridge.live && bus.kind != can::TransportKind::kSocketCan) {
      f.Fail("origin", "is live, but bus '" + bus.name + "' is no hardware; expected sim");
    }
    if (!file.bridge.live && can::IsHardware(bus)) {
      f.Fail("origin", "is sim, but bus '" + bus.name + "' is the CAN controller " + bus.interface +
                           ": motors may be behind it; expected live");
    }
  }
}

void Describe(config::Fields& f, BridgeFile& file) {
  BridgeConfig& c = file.bridge;
  can::DescribeBuses(f, &file.buses);
  f.NeedWord("origin", c.live, {{"live", true}, {"sim", false}}, "hardware, or simulated axes");
  if (f.reads()) CheckOrigin(f, file);
  for (const can::BusEntry& bus : file.buses) c.bitrate_bit_s.push_back(bus.bitrate_bit_s);
  f("short_frames", c.short_frames, "torque and position without feed-forward");
  f.NeedList("joints", {1, types::kMaxJoints}, "in the order of the topics",
             [&](config::Fields& g) { DescribeJoint(g, c.joints.emplace_back(), file.buses); });
  f.List("gateways", {}, "between the bridge and the axes",
         [&](config::Fields& g) { DescribeGateway(g, c.gateways.emplace_back(), file); });
  f.List("body_nodes", {}, "feet and IMU", [&](config::Fields& g) {
    BodyNodeConfig& node = c.body_nodes.emplace_back();
    can::DescribeAddress(g, file.buses, &node.bus, &node.node);
    can::DescribeBodyPart(g, node.part, node.mounting_rpy_rad);
  });
  f("timing", c.timing, "of the bus");
  f("watchdog_proof", file.watchdog_proof,
    "default, none or a path; left out: default for hardware, none else");
  f.Others({"guard", "estop"});
  f.Check("joints", [&] { CheckBridgeConfig(c); });
}

}  // namespace sinew::bridge

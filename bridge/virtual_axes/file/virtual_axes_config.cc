#include "bridge/virtual_axes/file/virtual_axes_config.h"

#include <algorithm>

#include "components/base/types/joints.h"

namespace sinew::virtual_axes {
using config::kNotNegative;
using config::kPositive;

constexpr config::Range kPeriod{0, 60000};  // ms; 0: never

// `size_key` has the encoder's unit.
static void Describe(config::Fields& f, EncoderFault& c, const char* size_key) {
  const auto kind = f.NeedWord("kind", c.kind,
                               {{"frozen", EncoderFaultKind::kFrozen},
                                {"offset", EncoderFaultKind::kOffset},
                                {"scaled", EncoderFaultKind::kScaled}},
                               "of the fault");
  f("after_s", c.after_s, kNotNegative, "from the start");
  if (const auto offset = kind.Is({"offset"})) f.Need(size_key, c.size, "added");
  if (const auto scaled = kind.Is({"scaled"})) f.Need("share", c.size, "of the reading, more");
}

static void DescribeAxis(config::Fields& f, AxisConfig& c,
                         const std::vector<can::BusEntry>& buses) {
  can::DescribeAddress(f, buses, &c.bus, &c.node);
  f("joint", c.joint, {0, types::kMaxJoints - 1}, "of the simulation");
  can::DescribeFirmware(f, c.firmware);
  can::DescribeDirection(f, c.direction);
  f("zero_rev", c.zero_rev, "reading where the joint is at 0");
  f.Need("gear_ratio", c.gear_ratio, kPositive, "motor turns per output turn");
  f("torque_constant_Nm_A", c.torque_constant_Nm_A, kPositive, "of the motor");
  f("controller_torque_constant_Nm_A", c.controller_torque_constant_Nm_A, kPositive,
    "that the controller is set to");
  f("velocity_limit_rev_s", c.velocity_limit_rev_s, kPositive, "of the controller");
  f("current_limit_A", c.current_limit_A, kPositive, "of the controller");
  f.Milliseconds("watchdog_ms", c.watchdog_s, kNotNegative, "idles without setpoints; 0: off");
  f("bus_voltage_V", c.bus_voltage_V, kPositive, "reported");
  f("heartbeat_ms", c.rates.heartbeat_ms, kPeriod, "period; 0: never");
  f("encoder_ms", c.rates.encoder_ms, kPeriod, "period; 0: never");
  f("iq_ms", c.rates.iq_ms, kPeriod, "period; 0: never");
  f("bus_voltage_ms", c.rates.bus_voltage_ms, kPeriod, "period; 0: never");
  f.If("encoder_fault", "to test with",
       [&](config::Fields& g) { Describe(g, c.encoder_fault, "size_rev"); });
}

static void DescribeNode(config::Fields& f, SensorNodeConfig& c,
                         const std::vector<can::BusEntry>& buses) {
  can::DescribeAddress(f, buses, &c.bus, &c.node);
  f("joint", c.joint, {0, types::kMaxJoints - 1}, "of the simulation");
  can::DescribeDirection(f, c.direction);
  f("zero_rad", c.zero_rad, "reading where the joint is at 0");
  f("encoder_ms", c.encoder_ms, kPeriod, "period; 0: never");
  f("sensors_ms", c.sensors_ms, kPeriod, "period; 0: never");
  f("heartbeat_ms", c.heartbeat_ms, kPeriod, "period; 0: never");
  f.If("encoder_fault", "to test with",
       [&](config::Fields& g) { Describe(g, c.encoder_fault, "size_rad"); });
}

static void DescribeBodyNode(config::Fields& f, BodyNodeConfig& c,
                             const std::vector<can::BusEntry>& buses) {
  can::DescribeAddress(f, buses, &c.bus, &c.node);
  can::DescribeBodyPart(f, c.part, c.mounting_rpy_rad, [&](config::Fields& g) {
    g("force_noise_m_s2", c.force_noise_m_s2, kNotNegative, "standard deviation");
    g("rate_noise_rad_s", c.rate_noise_rad_s, kNotNegative, "standard deviation");
  });
  f("sample_ms", c.sample_ms, kPeriod, "period; 0: never");
  f("heartbeat_ms", c.heartbeat_ms, kPeriod, "period; 0: never");
  f.If("fault", "to test with", [&](config::Fields& g) {
    g.NeedWord("kind", c.fault.kind,
               {{"frozen", BodyFaultKind::kFrozen}, {"lost", BodyFaultKind::kLost}}, "of it");
    g("after_s", c.fault.after_s, kNotNegative, "from the start");
  });
}

void Describe(config::Fields& f, VirtualAxesFile& file) {
  VirtualAxesConfig& c = file.axes;
  std::optional<std::filesystem::path> world, surrogate;
  can::DescribeBuses(f, &file.buses);
  f.NeedList("axes", {}, "of the controllers",
             [&](config::Fields& g) { DescribeAxis(g, c.axes.emplace_back(), file.buses); });
  f.List("sensor_nodes", {}, "output encoders, loads, pressures",
         [&](config::Fields& g) { DescribeNode(g, c.nodes.emplace_back(), file.buses); });
  f.List("gateways", {}, "hold axes that are not heard", [&](config::Fields& g) {
    GatewayConfig& gateway = c.gateways.emplace_back();
    can::DescribeAddress(g, file.buses, &gateway.bus, &gateway.node);
    std::vector<std::int64_t> nodes;
    g.Need("axes", nodes, {0, can::kMaxNode}, "their nodes");
    gateway.axes.assign(nodes.begin(), nodes.end());
  });
  f.List("body_nodes", {}, "feet and IMU",
         [&](config::Fields& g) { DescribeBodyNode(g, c.body_nodes.emplace_back(), file.buses); });
  c.step_s = 1e-3;
  f.Milliseconds("step_ms", c.step_s, {0.01, 100.0}, "of the simulation");
  f("hold_start_s", c.hold_start_s, kNotNegative, "held so long, or until all axes are driven");
  f("world", world, "a world file, in place of the surrogate");
  f("surrogate", surrogate, "its file; left out: its defaults");
  for (const AxisConfig& axis : c.axes) file.joints = std::max(file.joints, axis.joint + 1);
  for (const SensorNodeConfig& node : c.nodes) file.joints = std::max(file.joints, node.joint + 1);
  f.Require(!world || !surrogate, "world", "and surrogate, expected one of them");
  file.world_path = world.value_or("");
  file.surrogate_path = surrogate.value_or("");
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

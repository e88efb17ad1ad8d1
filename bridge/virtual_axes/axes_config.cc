#include "bridge/virtual_axes/axes_config.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "bridge/can/compact.h"
#include "components/base/types/require.h"

namespace sinew::virtual_axes {
using types::Require;

void CheckVirtualAxesConfig(const VirtualAxesConfig& config, int joints, int buses) {
  Require(config.step_s >= 1e-5 && config.step_s <= 0.1,
          "step_s = " + std::to_string(config.step_s) + ", expected 1e-5 to 0.1");
  Require(!config.axes.empty() || !config.nodes.empty(), "no axes and no sensor nodes");
  if (config.hold_start_s) {
    Require(std::isfinite(*config.hold_start_s) && *config.hold_start_s >= 0.0,
            "hold_start_s must not be negative");
    Require(!config.axes.empty(), "hold_start_s: no axis would ever let the plant go");
  }
  std::set<std::pair<int, int>> used;
  const auto check = [&](const std::string& what, int bus, int node, int joint, int direction) {
    Require(bus >= 0 && bus < buses, what + ": no bus " + std::to_string(bus));
    Require(node >= 0 && node <= can::kMaxNode,
            what + ": node " + std::to_string(node) + ", expected 0 to 63");
    Require(used.emplace(bus, node).second,
            what + ": node " + std::to_string(node) + " is used twice");
    Require(joint >= 0 && joint < joints, what + ": joint " + std::to_string(joint) +
                                              ", the plant has " + std::to_string(joints));
    Require(direction == 1 || direction == -1,
            what + ": direction " + std::to_string(direction) + ", expected 1 or -1");
  };
  for (const AxisConfig& a : config.axes) {
    check("axis", a.bus, a.node, a.joint, a.direction);
    Require(a.gear_ratio > 0.0 && a.torque_constant_Nm_A > 0.0 &&
                a.controller_torque_constant_Nm_A > 0.0 && a.velocity_limit_rev_s > 0.0 &&
                a.current_limit_A > 0.0 && a.encoder_counts_rev > 0.0 && a.watchdog_s >= 0.0 &&
                std::isfinite(a.zero_rev),
            "axis of node " + std::to_string(a.node) +
                ": ratios, constants and limits must be positive");
  }
  for (const SensorNodeConfig& n : config.nodes) {
    check("sensor node", n.bus, n.node, n.joint, n.direction);
  }
  for (const BodyNodeConfig& n : config.body_nodes) {
    const std::string part = can::BodyPartName(n.part);
    check(part, n.bus, n.node, 0, 1);
    const bool is_imu = n.part == can::BodyPart::kImu;
    for (const double angle_rad : n.mounting_rpy_rad) {
      Require(std::isfinite(angle_rad), part + ": mounting_rpy_rad must be finite");
      Require(is_imu || angle_rad == 0.0, part + ": mounting_rpy_rad is for an imu");
    }
    for (const double noise : {n.force_noise_m_s2, n.rate_noise_rad_s}) {
      Require(std::isfinite(noise) && noise >= 0.0, part + ": noise must not be negative");
      Require(is_imu || noise == 0.0, part + ": noise is for an imu");
    }
    Require(n.sample_ms >= 0 && n.heartbeat_ms >= 0, part + ": periods must not be negative");
    Require(std::isfinite(n.fault.after_s) && n.fault.after_s >= 0.0,
            part + ": after_s must not be negative");
  }
  std::set<std::pair<int, int>> behind;
  for (const GatewayConfig& g : config.gateways) {
    check("gateway", g.bus, g.node, 0, 1);
    const std::string who = "gateway of node " + std::to_string(g.node) + ": ";
    Require(!g.axes.empty() && g.axes.size() <= std::size_t{can::kCompactJoints},
            who + std::to_string(g.axes.size()) + " axes, expected 1 to " +
                std::to_string(can::kCompactJoints));
    for (const int node : g.axes) {
      Require(std::any_of(config.axes.begin(), config.axes.end(),
                          [&](const AxisConfig& a) { return a.bus == g.bus && a.node == node; }),
              who + "no axis of node " + std::to_string(node) + " on its bus");
      Require(behind.emplace(g.bus, node).second,
              who + "axis of node " + std::to_string(node) + " is behind a gateway already");
    }
  }
}

}  // namespace sinew::virtual_axes

#include "bridge/joints/joint_config.h"

#include <set>
#include <span>
#include <utility>

#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"
#include "bridge/joints/braking.h"
#include "components/base/types/angle.h"
#include "components/base/types/joints.h"
#include "components/base/types/require.h"
#include "components/base/types/text.h"
#include "components/robot/provider/plant.h"

namespace sinew::bridge {
using types::Require;

namespace {

using can::Command;

constexpr std::array kAxisCommands = {Command::kHeartbeat,       Command::kGetMotorError,
                                      Command::kGetEncoderError, Command::kGetEncoderEstimates,
                                      Command::kGetIq,           Command::kGetControllerError};
constexpr std::array kNodeCommands = {can::NodeCommand::kHeartbeat,
                                      can::NodeCommand::kOutputEncoder,
                                      can::NodeCommand::kJointSensors};
constexpr std::array kFootCommands = {can::NodeCommand::kHeartbeat, can::NodeCommand::kFootForces};
constexpr std::array kImuCommands = {can::NodeCommand::kHeartbeat, can::NodeCommand::kImuForce,
                                     can::NodeCommand::kImuRate, can::NodeCommand::kImuOrientation};

bool IsDirection(int direction) { return direction == 1 || direction == -1; }

// Each node number at most once on a bus.
class NodeNumbers {
 public:
  explicit NodeNumbers(int buses) : buses_(buses) {}
  void Claim(const std::string& who, int bus, int node) {
    Require(bus >= 0 && bus < buses_, who + "no bus " + std::to_string(bus));
    Require(node >= 0 && node <= can::kMaxNode,
            who + "node " + std::to_string(node) + ", expected 0 to 63");
    Require(used_.emplace(bus, node).second,
            who + "node " + std::to_string(node) + " is used twice");
  }

 private:
  int buses_;
  std::set<std::pair<int, int>> used_;
};

void CheckZeroCheck(const std::string& who, const JointConfig& c) {
  if (!c.zero_check) {
    Require(!c.home_by_whole_turns, who + "homing needs a zero_check");
    return;
  }
  Require(c.output.has_value(), who + "zero_check needs a sensor node");
  Require(c.zero_check->play_rad >= 0.0 && c.zero_check->tolerance_rad > 0.0,
          who + "zero_check needs play_rad >= 0 and tolerance_rad > 0");
  const double largest_rev = c.zero_check->largest_rad() * c.gear_ratio / types::kTwoPi;
  Require(
      !c.home_by_whole_turns || largest_rev < 0.5,
      who + types::Text(
                "whole turns are ambiguous: play and tolerance are %.2f of a motor turn, expected "
                "below 0.5",
                largest_rev));
}

void CheckBraking(const std::string& who, const JointConfig& c) {
  const Braking& b = *c.limits.braking;
  Require(b.reflected_inertia_kg_m2 > 0.0 && b.max_inertia_kg_m2 >= b.reflected_inertia_kg_m2,
          who + "braking needs 0 < reflected_inertia_kg_m2 <= max_inertia_kg_m2");
  Require(b.load_torque_Nm >= 0.0 && b.command_delay_s >= 0.0,
          who + "braking needs load_torque_Nm >= 0 and command_delay_ms >= 0");
  const double a = BrakingDeceleration(c);
  Require(
      a > 0.0,
      who + types::Text(
                "braking: the motor cannot brake a load of %.3g Nm (%.3g rad/s^2 remain), expected "
                "above 0",
                b.load_torque_Nm, a));
}

void CheckJoint(const JointConfig& c, NodeNumbers* nodes) {
  const std::string who = "joint '" + c.name + "': ";
  nodes->Claim(who, c.bus, c.node);
  if (c.output) nodes->Claim(who, c.bus, c.output->node);
  Require(IsDirection(c.direction) && (!c.output || IsDirection(c.output->direction)),
          who + "direction must be 1 or -1");
  Require(
      c.gear_ratio > 0.0 && c.torque_constant_Nm_A > 0.0 && c.controller_torque_constant_Nm_A > 0.0,
      who + "gear ratio and torque constants must be positive");
  Require(c.torque_efficiency > 0.0 && c.torque_efficiency <= 1.0,
          who + "torque_efficiency must be above 0, at most 1");
  const JointLimits& limits = c.limits;
  Require(limits.motor_torque_Nm > 0.0 && limits.current_A > 0.0 && limits.velocity_rad_s > 0.0,
          who + "limits of torque, current and velocity must be positive");
  CheckZeroCheck(who, c);
  Require(c.compliance_rad >= 0.0, who + "compliance_rad must not be negative");
  Require(
      limits.lower_rad < limits.upper_rad && limits.margin_rad >= 0.0,
      who + "position limits must have lower_rad < upper_rad and a margin that is not negative");
  if (limits.braking) CheckBraking(who, c);
}

void CheckBodyNodes(const BridgeConfig& config, NodeNumbers* nodes) {
  std::set<can::BodyPart> measured;
  for (const BodyNodeConfig& c : config.body_nodes) {
    const std::string part = can::BodyPartName(c.part);
    const std::string who = part + " of node " + std::to_string(c.node) + ": ";
    nodes->Claim(who, c.bus, c.node);
    Require(measured.insert(c.part).second, who + "another node measures the " + part);
    const bool is_imu = c.part == can::BodyPart::kImu;
    for (const double angle_rad : c.mounting_rpy_rad) {
      Require(std::isfinite(angle_rad), who + "mounting_rpy_rad must be finite");
      Require(is_imu || angle_rad == 0.0, who + "mounting_rpy_rad is for an imu");
    }
    if (config.gateways.empty()) continue;
    const GatewayConfig& gateway = config.gateways.front();
    Require(!(is_imu ? gateway.carries_imu : gateway.carries_feet),
            who + "the gateway of node " + std::to_string(gateway.node) + " carries the " +
                (is_imu ? "imu" : "feet") + " already");
  }
}

}  // namespace

void CheckBridgeConfig(const BridgeConfig& config) {
  const auto buses = static_cast<int>(config.bitrate_bit_s.size());
  Require(buses >= 1 && buses <= provider::BusReport::kMaxBuses,
          std::to_string(buses) + " buses, expected 1 to " +
              std::to_string(provider::BusReport::kMaxBuses));
  Require(
      !config.joints.empty() && config.joints.size() <= static_cast<std::size_t>(types::kMaxJoints),
      std::to_string(config.joints.size()) + " joints, expected 1 to " +
          std::to_string(types::kMaxJoints));
  NodeNumbers nodes(buses);
  for (const JointConfig& c : config.joints) CheckJoint(c, &nodes);
  std::set<int> behind;
  for (const GatewayConfig& g : config.gateways) {
    const std::string who = "gateway of node " + std::to_string(g.node) + ": ";
    nodes.Claim(who, g.bus, g.node);
    Require(!g.joints.empty() && g.joints.size() <= std::size_t{can::kCompactJoints},
            who + std::to_string(g.joints.size()) + " joints, expected 1 to " +
                std::to_string(can::kCompactJoints));
    for (const int j : g.joints) {
      Require(j >= 0 && static_cast<std::size_t>(j) < config.joints.size(),
              who + "no joint " + std::to_string(j));
      const JointConfig& c = config.joints[static_cast<std::size_t>(j)];
      Require(c.bus == g.bus, who + "joint '" + c.name + "' is on another bus");
      Require(behind.insert(j).second, who + "joint '" + c.name + "' is behind a gateway already");
    }
  }
  CheckBodyNodes(config, &nodes);
}

std::vector<can::IdFilter> ReceiveFilters(const BridgeConfig& config, int bus, bool masters) {
  std::vector<can::IdFilter> filters;
  const auto pass = [&filters](std::uint32_t id) {
    filters.push_back({id, can::kMaxStandardId, false});
  };
  for (const JointConfig& joint : config.joints) {
    if (joint.bus != bus) continue;
    for (const Command command : kAxisCommands) pass(can::Identifier(joint.node, command));
    if (masters) {
      for (const Command command : can::kMasterCommands) {
        pass(can::Identifier(joint.node, command));
      }
    }
    if (!joint.output) continue;
    for (const can::NodeCommand command : kNodeCommands) {
      pass(can::Identifier(joint.output->node, command));
    }
  }
  for (const GatewayConfig& gateway : config.gateways) {
    if (gateway.bus != bus) continue;
    for (int k = 0; k < can::kCompactStateFrames; ++k) {
      pass(can::Identifier(gateway.node, can::StateCommand(k)));
    }
    if (!masters) continue;
    for (const can::Frame& frame : can::EncodeReferences(gateway.node, {})) pass(frame.id);
  }
  for (const BodyNodeConfig& body : config.body_nodes) {
    if (body.bus != bus) continue;
    const auto commands = body.part == can::BodyPart::kImu
                              ? std::span<const can::NodeCommand>(kImuCommands)
                              : std::span<const can::NodeCommand>(kFootCommands);
    for (const can::NodeCommand command : commands) pass(can::Identifier(body.node, command));
  }
  return filters;
}

}  // namespace sinew::bridge

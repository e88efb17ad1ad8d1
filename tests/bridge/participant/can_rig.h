// Bridge, bus and virtual axes as processes, with the surrogate or the world behind the axes; the
// test plays control and operator over DDS.
#pragma once

#include <gtest/gtest.h>
#include <signal.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/bus.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/sensors.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <sstream>

#include "bridge/can/codec.h"
#include "bridge/can/transport/virtual_can.h"
#include "components/base/types/clock/clock.h"
#include "components/topics/node/node.h"
#include "tests/support/edited_config.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Program;

inline std::string ReadText(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// The four bytes of a torque setpoint, as candump writes them.
inline std::string Setpoint(double torque_Nm) {
  const auto value = static_cast<float>(torque_Nm);
  unsigned char bytes[4];
  std::memcpy(bytes, &value, sizeof bytes);
  char text[9];
  std::snprintf(text, sizeof text, "%02X%02X%02X%02X", bytes[0], bytes[1], bytes[2], bytes[3]);
  return text;
}

// A list entry of a YAML text once more, from `from` up to `to`, with the next node numbers.
inline std::string Twice(const std::string& text, const std::string& from, const std::string& to) {
  const std::size_t begin = text.find(from), end = text.find(to, begin);
  EXPECT_NE(end, std::string::npos) << from;
  std::string entry = text.substr(begin, end - begin);
  for (const auto& [number, next] :
       {std::pair("node: 33", "node: 34"), std::pair("node: 3\n", "node: 4\n"),
        std::pair("joint: 0", "joint: 1"), std::pair("name: joint\n", "name: second\n")}) {
    if (entry.find(number) != std::string::npos) entry = testing::Edited(entry, {{number, next}});
  }
  return text.substr(0, end) + entry + text.substr(end);
}

struct RigOptions {
  bool second_joint = false;
  std::string rest = "idle";     // what the other joint does
  bool gateway = false;          // the compact exchange through the gateway of node 48
  bool world = false;            // behind the axes, instead of the surrogate
  std::string bridge_more = "";  // at the end of the bridge's configuration
  std::vector<std::string> bridge_arguments = {};
  int watchdog_ms = 500;           // of the axes
  std::string serial_number = "";  // in the joint map
  bool realtime = false;           // bus, axes and bridge under SCHED_FIFO
};

class Rig {
 public:
  explicit Rig(int domain, const RigOptions& rig_options = {})
      : domain_(domain), node_(NodeOptions(domain)) {
    const std::string bus_path = (folder_.path() / "bus").string();
    bus_path_ = bus_path;
    using testing::Edited;
    // About what gravity needs: the link does not run to its end while a loaded machine stalls us.
    folder_.Write("surrogate.yaml",
                  testing::EditedRigConfig("surrogate.yaml", {{"initial_pressure_bar: 4.0",
                                                               "initial_pressure_bar: 2.0"}}));
    // A loaded machine stalls a process for 100 ms now and then: what is tested here is what
    // follows, not when.
    std::string axes = testing::RigConfigOnBus(
        "virtual_axes.yaml", bus_path,
        {{"watchdog_ms: 100", "watchdog_ms: " + std::to_string(rig_options.watchdog_ms)}});
    if (rig_options.second_joint)
      axes = Twice(Twice(axes + "#\n", "  - node: 33", "#\n"), "  - node: 3\n", "sensor_nodes");
    if (rig_options.gateway) {
      axes = Edited(axes, {{"encoder_ms: 2", "encoder_ms: 0"}});  // the state carries it
      axes += "gateways:\n  - {node: 48, axes: [3]}\n";
    }
    if (rig_options.world) {
      axes = Edited(axes, {{"surrogate: surrogate.yaml",
                            "world: " SINEW_SOURCE_DIR "/robots/rig/world.yaml"}});
    }
    axes_config_ = folder_.Write("virtual_axes.yaml", axes);
    testing::Edits edits = {
        {"lost_after_ms: 60", "lost_after_ms: 1000\n  closed_loop_timeout_ms: 5000"},
        {"heartbeat_timeout_ms: 350", "heartbeat_timeout_ms: 3000"},
        {"fault_after_ms: 60", "fault_after_ms: 1000"},
        {"on_joint_fault: idle", "on_joint_fault: " + rig_options.rest}};
    if (rig_options.gateway)
      edits.emplace_back("timing:", "gateways:\n  - {node: 48, joints: [joint]}\ntiming:");
    std::string bridge = testing::RigConfigOnBus("can_bridge.yaml", bus_path, edits);
    if (rig_options.second_joint) bridge = Twice(bridge, "  - name: joint\n", "timing:");
    if (!rig_options.serial_number.empty()) {
      bridge = Edited(bridge, {{"  - name: joint\n", "  - name: joint\n    serial_number: " +
                                                         rig_options.serial_number + "\n"}});
    }
    bridge_config_ = folder_.Write("can_bridge.yaml", bridge + rig_options.bridge_more);
    bridge_arguments_ = rig_options.bridge_arguments;
    log_ = (folder_.path() / "bus.log").string();
    if (rig_options.realtime) {
      realtime_ = {"--realtime"};
      bridge_arguments_.push_back("--realtime");
    }
    std::vector<std::string> bus = {"sinew-can-bus", "--bus", bus_path, "--log", log_};
    bus.insert(bus.end(), realtime_.begin(), realtime_.end());
    bus_ = Start(bus);
    StartAxes();
    StartBridge();
  }

  // Fast DDS 2.9 may crash in a participant that ends after a peer was killed: an orderly end.
  ~Rig() {
    bridge_->Signal(SIGTERM);
    (void)bridge_->Wait(seconds(10));
  }

  void StartAxes() {
    std::vector<std::string> arguments = {"sinew-virtual-axes", "--config", axes_config_};
    arguments.insert(arguments.end(), realtime_.begin(), realtime_.end());
    axes_ = Start(arguments);
  }
  void StartBridge() {
    std::vector<std::string> arguments = {"sinew-can-bridge", "--config", bridge_config_,
                                          "--domain", std::to_string(domain_)};
    arguments.insert(arguments.end(), bridge_arguments_.begin(), bridge_arguments_.end());
    bridge_ = Start(arguments);
  }
  Program& axes() { return *axes_; }
  Program& bridge() { return *bridge_; }
  const std::string& log() const { return log_; }
  const std::string& bus_path() const { return bus_path_; }
  const std::filesystem::path& folder() const { return folder_.path(); }
  const std::string& bridge_config() const { return bridge_config_; }

  // Reads states and answers each with this torque until `done` or the time is over.
  bool Run(double motor_torque_Nm, seconds limit,
           const std::function<bool(const msg::JointState&)>& done) {
    const auto give_up = std::chrono::steady_clock::now() + limit;
    while (std::chrono::steady_clock::now() < give_up) {
      const auto state = states_.WaitNext(milliseconds(200));
      if (!state) continue;
      last_ = *state;
      msg::JointCommand command;
      command.header = state->header;
      command.joint_count = state->joint_count;
      for (int j = 0; j < state->joint_count; ++j) {
        const auto i = static_cast<std::size_t>(j);
        command.mode[i] = position_rad ? msg::CommandMode::kPosition : msg::CommandMode::kTorque;
        command.position_rad[i] = position_rad.value_or(0.0);
        command.motor_torque_Nm[i] = motor_torque_Nm;
      }
      (void)commands_.Write(command);
      msg::ValveCommand valves;
      valves.header = state->header;
      valves.joint_count = 1;
      valves.valve_open[0] = valve_open;
      (void)valves_.Write(valves);
      if (late_valve_open) {
        --valves.header.tick;
        valves.valve_open[0] = *late_valve_open;
        (void)valves_.Write(valves);
      }
      while (const auto actuator = actuators_.TakeNext()) actuator_ = *actuator;
      while (const auto bus = bus_status_.TakeNext()) status_ = *bus;
      if (done(*state)) return true;
    }
    return false;
  }
  void Operator(msg::OperatorAction action) {
    msg::OperatorCommand command;
    command.header = last_.header;
    command.action = action;
    (void)operator_.Write(command);
  }
  // Sends this action, again every 0.2 s, until the provider is in the state.
  bool Order(msg::OperatorAction action, msg::RobotState state) {
    auto next = std::chrono::steady_clock::now();
    return Run(0.0, seconds(15), [&](const msg::JointState& s) {
      if (s.robot_state == state) return true;
      if (std::chrono::steady_clock::now() >= next) {
        Operator(action);
        next = std::chrono::steady_clock::now() + milliseconds(200);
      }
      return false;
    });
  }
  bool Arm() { return Order(msg::OperatorAction::kArm, msg::RobotState::kArmed); }

  const msg::JointState& last() const { return last_; }
  const std::optional<msg::ActuatorState>& actuator() const { return actuator_; }
  const std::optional<msg::BusStatus>& status() const { return status_; }
  bool valve_open = true;
  std::optional<bool> late_valve_open;  // of the tick before, sent after that
  std::optional<double> position_rad;   // commanded instead of the torque

 private:
  static node::Options NodeOptions(int domain) {
    node::Options options;
    options.component = options.name = "test";
    options.domain_id = domain;
    return options;
  }
  static std::unique_ptr<Program> Start(std::vector<std::string> arguments) {
    arguments[0] = std::string(SINEW_BIN_DIR) + "/" + arguments[0];
    return std::make_unique<Program>(arguments);
  }

  int domain_;
  testing::TemporaryFolder folder_;
  std::string axes_config_, bridge_config_, log_, bus_path_;
  std::vector<std::string> bridge_arguments_, realtime_;
  node::Node node_;
  node::Reader<msg::JointState> states_ = node_.MakeReader(node::kJointState);
  node::Reader<msg::ActuatorState> actuators_ = node_.MakeReader(node::kActuatorState);
  node::Reader<msg::BusStatus> bus_status_ = node_.MakeReader(node::kBusStatus);
  node::Writer<msg::JointCommand> commands_ = node_.MakeWriter(node::kJointCommand);
  node::Writer<msg::ValveCommand> valves_ = node_.MakeWriter(node::kValveCommand);
  node::Writer<msg::OperatorCommand> operator_ = node_.MakeWriter(node::kOperatorCommand);
  std::unique_ptr<Program> bus_, axes_, bridge_;
  msg::JointState last_;
  std::optional<msg::ActuatorState> actuator_;
  std::optional<msg::BusStatus> status_;
};

// The frames of node 3 on the bus of a rig, by the bus' own stamps (CLOCK_MONOTONIC).
class AxisWatch {
 public:
  explicit AxisWatch(const Rig& rig) : bus_({.bus = rig.bus_path()}) {}

  // By the axis' newest heartbeat.
  bool InClosedLoop() {
    can::Received received;
    while (bus_.Receive(std::chrono::nanoseconds(0), &received)) {
      const auto address = can::AddressOf(received.frame);
      const auto heartbeat = can::Decode<can::Heartbeat>(received.frame, can::Firmware::k0_5_6);
      if (!address || address->node != 3 || !heartbeat) continue;
      closed_loop_ = heartbeat->axis_state == can::AxisState::kClosedLoopControl;
    }
    return closed_loop_;
  }

  // When the axis was requested to idle at or after a time, in ms since then; nothing: not within
  // the limit.
  std::optional<double> IdleAfter(std::int64_t since_ns, milliseconds limit = seconds(5)) {
    return FrameAfter(since_ns, limit, [](const can::Frame& frame) {
      const auto state = can::Decode<can::SetAxisState>(frame, can::Firmware::k0_5_6);
      return state && state->state == can::AxisState::kIdle;
    });
  }
  template <class Condition>
  std::optional<double> FrameAfter(std::int64_t since_ns, milliseconds limit, Condition condition) {
    const std::int64_t give_up_ns =
        types::MonotonicNow_ns() + std::chrono::nanoseconds(limit).count();
    can::Received received;
    while (types::MonotonicNow_ns() < give_up_ns) {
      if (!bus_.Receive(milliseconds(20), &received) || received.stamp_ns < since_ns) continue;
      const auto address = can::AddressOf(received.frame);
      if (!address || address->node != 3 || !condition(received.frame)) continue;
      closed_loop_ = false;  // not known any more
      return 1e-6 * static_cast<double>(received.stamp_ns - since_ns);
    }
    return std::nullopt;
  }

 private:
  can::VirtualCan bus_;
  bool closed_loop_ = false;
};

}  // namespace sinew

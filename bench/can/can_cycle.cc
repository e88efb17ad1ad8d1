// The bridge's own time per cycle in the running system: twelve joints on two virtual buses, as
// processes (two sinew-can-bus, sinew-virtual-axes, sinew-can-bridge), and this program as the
// controller that answers every joint_state. Frames to topics and back, without the wire and
// without waiting: what the bridge itself says at its end.
//   can_cycle [--seconds N] [--rate HZ] [--nodes] [--realtime] [--without-topics] [--domain N]
//   [--qos FILE]
// --without-topics: this program has the bridge's plant itself, on the same buses and at the same
// rate, and no DDS: Act and Step, with what it costs to wake buses and axes.
// With --realtime the bridge has SCHED_FIFO, as the units give it: else those it wakes (controller,
// buses) may take its processor in the middle of its work, which then counts as its own.
// Goal: 50 us at the median, 500 us at 99.9 %.
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bridge/can/file/bus_config.h"
#include "bridge/joints/can_plant.h"
#include "bridge/joints/file/bridge_config.h"
#include "components/base/types/clock/clock.h"
#include "components/robot/provider/work_time.h"
#include "components/topics/node/node.h"
#include "components/topics/node/realtime.h"
#include "tests/support/motors_alone.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Program;

constexpr int kJoints = 12;

double TorqueOf(std::uint64_t tick, std::size_t joint) {
  return 2e-3 * std::sin(0.02 * static_cast<double>(tick + 20 * joint));
}

std::string Buses(const std::string& folder) {
  std::string text = "buses:\n";
  for (const char* name : {"a", "b"}) {
    text += std::string("  - {name: ") + name + ", transport: virtual, bus: " + folder + "/" +
            name + "}\n";
  }
  return text;
}

const char* BusOf(int joint) { return joint < kJoints / 2 ? "a" : "b"; }

std::string BridgeText(const std::string& folder, bool nodes) {
  std::ostringstream text;
  text << "schema: sinew-can-bridge/1\norigin: sim\n" << Buses(folder) << "joints:\n";
  for (int j = 0; j < kJoints; ++j) {
    text << "  - {name: joint" << j << ", bus: " << BusOf(j) << ", node: " << j + 1
         << ", gear_ratio: 100, torque_constant_Nm_A: 0.0159155"
         << ", controller_torque_constant_Nm_A: 0.0137833, limits: {motor_torque_Nm: 0.398"
         << ", current_A: 25, velocity_rad_s: 25, lower_rad: -1000, upper_rad: 1000}";
    if (nodes) text << ", sensor_node: {node: " << j + 33 << "}";
    text << "}\n";
  }
  // A cycle without processor time shows in the times; it must not end the run with a fault.
  text << "timing: {iq_every_cycles: 4, lost_after_ms: 1000, heartbeat_timeout_ms: 2000}\n"
          "guard: {missed_periods: 50, fault_after_ms: 2000}\n";
  return text.str();
}

std::string AxesText(const std::string& folder, bool nodes) {
  std::ostringstream text;
  text << "schema: sinew-virtual-axes/1\n"
       << Buses(folder) << "surrogate: surrogate.yaml\nstep_ms: 1\naxes:\n";
  for (int j = 0; j < kJoints; ++j) {
    text << "  - {bus: " << BusOf(j) << ", node: " << j + 1 << ", joint: " << j
         << ", gear_ratio: 100, velocity_limit_rev_s: 500, watchdog_ms: 1000, encoder_ms: 4}\n";
  }
  if (nodes) text << "sensor_nodes:\n";
  for (int j = 0; nodes && j < kJoints; ++j) {
    text << "  - {bus: " << BusOf(j) << ", node: " << j + 33 << ", joint: " << j
         << ", encoder_ms: 4, sensors_ms: 8}\n";
  }
  return text.str();
}

// The work of a cycle of the bridge's plant alone.
void RunWithoutTopics(const std::string& config_path, std::uint64_t cycles, double rate_Hz,
                      bool realtime) {
  const config::Section section = config::Section::Load(config_path, "sinew-can-bridge/1");
  const bridge::BridgeFile file = config::Read<bridge::BridgeFile>(section);
  std::vector<std::unique_ptr<can::Transport>> transports;
  std::vector<can::Transport*> pointers;
  for (std::size_t bus = 0; bus < file.buses.size(); ++bus) {
    transports.push_back(
        can::OpenBus(file.buses[bus], bridge::ReceiveFilters(file.bridge, static_cast<int>(bus))));
    pointers.push_back(transports.back().get());
  }
  bridge::CanPlant plant(file.bridge, pointers);
  if (realtime) {
    node::PrepareRealtime("can-bridge");
    node::BeginRealtime();
  }
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  provider::WorkTime work;
  const auto period = std::chrono::nanoseconds(std::llround(1e9 / rate_Hz));
  auto end = std::chrono::steady_clock::now();
  for (std::uint64_t tick = 0; tick < cycles; ++tick) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      command.mode[j] = types::ControlMode::kTorque;
      command.motor_torque_Nm[j] = TorqueOf(tick, j);
    }
    end += period;
    work.Resume(types::MonotonicNow_ns());
    plant.Act(command, 1.0 / rate_Hz);
    work.Pause(types::MonotonicNow_ns());
    std::this_thread::sleep_until(end);
    work.Resume(types::MonotonicNow_ns());
    plant.Step(command, 1.0 / rate_Hz, &sensors);
    work.Pause(types::MonotonicNow_ns());
    work.EndCycle();
  }
  plant.ShutDown();
  if (sensors.any_fault()) throw std::runtime_error("a fault: " + sensors.message);
  std::printf("  work of a cycle, without topics: median %.0f us, 99.9 %% %.0f us\n",
              work.Quantile_us(0.5), work.Quantile_us(0.999));
}

// Arms the robot and answers each joint_state, until it was armed for so many cycles.
void CommandArmed(const node::Options& options, std::uint64_t cycles,
                  std::chrono::duration<double> limit, Program& bridge) {
  node::Node node(options);
  auto states = node.MakeReader(node::kJointState);
  auto commands = node.MakeWriter(node::kJointCommand);
  auto operators = node.MakeWriter(node::kOperatorCommand);
  const auto give_up = std::chrono::steady_clock::now() + limit;
  std::uint64_t armed = 0;
  while (armed < cycles) {
    if (std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("the robot was not armed for long enough\n" + bridge.error());
    }
    const auto state = states.WaitNext(milliseconds(200));
    if (!state) continue;
    const std::uint64_t tick = state->header.tick;
    if (state->robot_state == msg::RobotState::kArmed) {
      ++armed;
    } else if (tick % 60 == 0) {
      msg::OperatorCommand command;
      command.header = state->header;
      command.action = state->robot_state == msg::RobotState::kFault ? msg::OperatorAction::kReset
                                                                     : msg::OperatorAction::kArm;
      (void)operators.Write(command);
    }
    msg::JointCommand command;
    command.header = state->header;
    command.joint_count = kJoints;
    for (std::size_t j = 0; j < kJoints; ++j) {
      command.mode[j] = msg::CommandMode::kTorque;
      command.motor_torque_Nm[j] = TorqueOf(tick, j);
    }
    (void)commands.Write(command);
  }
}

int Main(int argc, char** argv) {
  double duration_s = 20.0, rate_Hz = 240.0;
  bool nodes = false, realtime = false, without_topics = false;
  int domain = 98;
  std::string qos;
  CLI::App app("The bridge's own time per cycle in the running system");
  app.add_option("--seconds", duration_s, "Armed for so long")->capture_default_str();
  app.add_option("--rate", rate_Hz, "Cycles per second")->capture_default_str();
  app.add_flag("--nodes", nodes, "With a sensor node at each joint");
  app.add_flag("--realtime", realtime, "The bridge with SCHED_FIFO 40 (needs the right to)");
  app.add_flag("--without-topics", without_topics, "The bridge's plant alone, without DDS");
  app.add_option("--domain", domain, "DDS domain")->capture_default_str();
  app.add_option("--qos", qos, "XML file with QoS profiles instead of the built-in ones");
  CLI11_PARSE(app, argc, argv);

  const testing::TemporaryFolder folder;
  const std::string place = folder.path().string(), bin = std::string(SINEW_BIN_DIR) + "/";
  folder.Write("surrogate.yaml", testing::kMotorsAlone);
  std::vector<std::unique_ptr<Program>> programs;
  const auto start = [&](std::vector<std::string> arguments) {
    arguments[0] = bin + arguments[0];
    programs.push_back(std::make_unique<Program>(arguments));
  };
  for (const char* name : {"a", "b"}) start({"sinew-can-bus", "--bus", place + "/" + name});
  start({"sinew-virtual-axes", "--config", folder.Write("axes.yaml", AxesText(place, nodes))});
  const std::string bridge_path = folder.Write("bridge.yaml", BridgeText(place, nodes));
  const auto cycles = static_cast<std::uint64_t>(duration_s * rate_Hz);
  if (without_topics) {
    RunWithoutTopics(bridge_path, cycles, rate_Hz, realtime);
    return 0;
  }
  std::vector<std::string> bridge_arguments = {
      "sinew-can-bridge",      "--config", bridge_path,           "--rate",
      std::to_string(rate_Hz), "--domain", std::to_string(domain)};
  if (!qos.empty()) bridge_arguments.insert(bridge_arguments.end(), {"--qos", qos});
  if (realtime) bridge_arguments.push_back("--realtime");
  start(bridge_arguments);
  Program& bridge = *programs.back();

  node::Options options;
  options.component = options.name = "commander";
  options.domain_id = domain;
  options.qos_path = qos;
  CommandArmed(options, cycles, std::chrono::duration<double>(60.0 + 2.0 * duration_s), bridge);
  bridge.Signal(SIGTERM);
  if (bridge.Wait(seconds(10)) != 0) throw std::runtime_error(bridge.error());
  std::printf("12 joints on two buses%s, %g Hz, %g s armed%s\n",
              nodes ? ", a sensor node at each" : "", rate_Hz, duration_s,
              realtime ? ", SCHED_FIFO" : "");
  std::istringstream log(bridge.error());
  for (std::string line; std::getline(log, line);) {
    for (const char* word : {"ticks, ", "work of a cycle", "frames sent", "fault"}) {
      if (line.find(word) != std::string::npos) std::printf("  %s\n", line.c_str());
    }
  }
  return 0;
}

}  // namespace
}  // namespace sinew

int main(int argc, char** argv) {
  try {
    return sinew::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "can_cycle: %s\n", error.what());
    return 1;
  }
}

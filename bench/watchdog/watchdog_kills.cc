// What a controller's sudden death does on the bus: the whole path as processes (sinew-can-bus,
// sinew-virtual-axes, sinew-can-bridge), a controller that is killed with SIGKILL again and again,
// and the frames that follow. Measured on the bus, by its own stamps:
//   last command -> first damping setpoint,   last command -> the request of the idle state
//   (fault).
// Says after each kill how long it took, and at the end median, 99th percentile and worst beside
// the goals.
// Also how long a controller that is started anew takes until its first command arrives.
//
// With --standby a second controller stands by each time, and the gap between the commands of the
// dead one and its own is measured instead; nothing may be a fault then.
//
// With --realtime all are under SCHED_FIFO, and so is a witness above them that wants to run every
// millisecond: a time beyond its goal in which the witness was over 1 ms late itself is the
// machine's, and is counted apart.
//   watchdog_kills [--kills N] [--rate HZ] [--standby] [--realtime] [--load] [--domain N]
//                  [--qos FILE]
#include <signal.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>

#include "bridge/can/codec.h"
#include "bridge/can/transport/virtual_can.h"
#include "components/base/types/clock/clock.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/realtime.h"
#include "tests/support/edited_config.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/witness.h"

namespace sinew {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using testing::Program;

constexpr int kNode = 3;
// Commands change every tick, so that a repeated one is distinguished from a fresh one.
constexpr double kTorque_Nm = 1e-3, kStep_Nm = 1e-6;
constexpr int kPattern = 64;
constexpr double kScale = 0.0137833 / 0.0159155;  // controller's torque over the motor's

// Where on DDS all of it runs.
struct Place {
  int domain = 97;
  std::string qos;  // a file of profiles instead of the built-in ones
  bool realtime = false;
};

node::Options NodeOptions(const Place& place, const std::string& name) {
  node::Options options;
  options.component = options.name = name;
  options.domain_id = place.domain;
  options.qos_path = place.qos;
  return options;
}

std::vector<std::string> Arguments(std::vector<std::string> program, const Place& place) {
  program.insert(program.end(), {"--domain", std::to_string(place.domain)});
  if (!place.qos.empty()) program.insert(program.end(), {"--qos", place.qos});
  if (place.realtime) program.emplace_back("--realtime");
  return program;
}

// The controller that will be killed: answers every joint_state.
int Command(const Place& place, const std::string& name) {
  if (place.realtime) node::PrepareRealtime("control");
  node::Node node(NodeOptions(place, name));
  auto states = node.MakeReader(node::kJointState);
  auto commands = node.MakeWriter(node::kJointCommand);
  node::BeginRealtime();
  while (::getppid() != 1) {
    const auto state = states.WaitNext(milliseconds(200));
    if (!state) continue;
    msg::JointCommand command;
    command.header = state->header;
    command.joint_count = 1;
    command.mode[0] = msg::CommandMode::kTorque;
    command.motor_torque_Nm[0] =
        kTorque_Nm + kStep_Nm * static_cast<double>(state->header.tick % kPattern);
    (void)commands.Write(command);
  }
  return 0;
}

// What the bus says about the axis since the last Clear.
class Watcher {
 public:
  explicit Watcher(const std::string& bus) : bus_({.bus = bus}), thread_([this] { Watch(); }) {}
  ~Watcher() {
    stop_ = true;
    thread_.join();
  }

  struct Seen {
    std::int64_t fresh_ns = 0;    // last setpoint that was a new command
    std::int64_t damping_ns = 0;  // first setpoint after it that was no command's
    std::int64_t idle_ns = 0;     // first idle state after it
    std::int64_t gap_ns = 0;      // longest between two new commands
    int fresh = 0;
    bool watchdog = false;  // the axis' own has expired: the whole machine stood still
  };
  Seen seen() {
    const std::lock_guard lock(mutex_);
    return seen_;
  }
  void Clear() {
    const std::lock_guard lock(mutex_);
    seen_ = {};
  }

 private:
  void Watch() {
    double last_Nm = 0.0;
    can::Received received;
    while (!stop_) {
      if (!bus_.Receive(milliseconds(20), &received)) continue;
      const auto address = can::AddressOf(received.frame);
      if (!address || address->node != kNode) continue;
      const std::lock_guard lock(mutex_);
      if (const auto input = can::Decode<can::SetInputTorque>(received.frame, kFirmware);
          address->command == can::Command::kSetInputTorque && input) {
        const double torque_Nm = input->torque_Nm / kScale;
        if (torque_Nm > 0.5 * kTorque_Nm) {
          if (torque_Nm == last_Nm) continue;  // the last command once more
          last_Nm = torque_Nm;
          const std::int64_t gap_ns = seen_.fresh > 0 ? received.stamp_ns - seen_.fresh_ns : 0;
          seen_ = {.fresh_ns = received.stamp_ns,
                   .gap_ns = std::max(seen_.gap_ns, gap_ns),
                   .fresh = seen_.fresh + 1,
                   .watchdog = seen_.watchdog};
        } else if (seen_.fresh > 0 && seen_.damping_ns == 0) {
          seen_.damping_ns = received.stamp_ns;
        }
      } else if (const auto heartbeat = can::Decode<can::Heartbeat>(received.frame, kFirmware);
                 heartbeat && heartbeat->axis_error == can::axis_error::kWatchdogTimerExpired) {
        seen_.watchdog = true;
      } else if (const auto state = can::Decode<can::SetAxisState>(received.frame, kFirmware);
                 address->command == can::Command::kSetAxisState && state &&
                 state->state == can::AxisState::kIdle && seen_.fresh > 0 && seen_.idle_ns == 0) {
        seen_.idle_ns = received.stamp_ns;
      }
    }
  }

  static constexpr can::Firmware kFirmware = can::Firmware::k0_5_6;
  can::VirtualCan bus_;
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  Seen seen_;
  std::thread thread_;
};

class Bench {
 public:
  Bench(const std::string& self, const Place& place, double rate_Hz)
      : self_(self), place_(place), node_(NodeOptions(place, "bench")) {
    const std::string rig = std::string(SINEW_SOURCE_DIR) + "/robots/rig/";
    const std::string bin = std::string(SINEW_BIN_DIR) + "/";
    const std::string bus = (folder_.path() / "bus").string();
    std::filesystem::copy_file(rig + "surrogate.yaml", folder_.path() / "surrogate.yaml");
    const auto start = [&](std::vector<std::string> arguments) {
      arguments[0] = bin + arguments[0];
      programs_.push_back(std::make_unique<Program>(arguments));
    };
    const auto beside = [&](std::vector<std::string> arguments) {
      if (place.realtime) arguments.emplace_back("--realtime");
      start(arguments);
    };
    beside({"sinew-can-bus", "--bus", bus});
    beside({"sinew-virtual-axes", "--config",
            folder_.Write("virtual_axes.yaml", testing::RigConfigOnBus("virtual_axes.yaml", bus))});
    // Pushed a thousand times one way, the link comes to its end stop: no fault here.
    const std::string bridge = folder_.Write(
        "can_bridge.yaml",
        testing::RigConfigOnBus("can_bridge.yaml", bus, {{"upper_rad: 1.9", "upper_rad: 3"}}));
    start(Arguments({"sinew-can-bridge", "--config", bridge, "--rate", std::to_string(rate_Hz)},
                    place));
    watcher_ = std::make_unique<Watcher>(bus);
  }

  ~Bench() {
    programs_.back()->Signal(SIGTERM);
    (void)programs_.back()->Wait(seconds(10));
  }

  // Milliseconds from the last command to damping and to the fault, and from the start of the
  // controller to the first command that we receive. witness_ms: how late the machine was.
  struct Times {
    double damping_ms = 0.0, fault_ms = 0.0, start_ms = 0.0, witness_ms = 0.0;
  };
  // Nothing when the machine stood still so long that the axis' own watchdog ended it (0.1 s).
  std::optional<Times> Kill(milliseconds after) {
    const std::int64_t start_ns = types::MonotonicNow_ns();
    Program commander(Arguments({self_, "--commander"}, place_));
    Await("commands on the topic", [&] {
      while (commands_.TakeNext()) received_ = true;
      return received_;
    });
    received_ = false;
    const double start_ms = 1e-6 * static_cast<double>(types::MonotonicNow_ns() - start_ns);
    // The bridge may discover the commander later than we do: then arming ends in a fault once
    // more.
    watcher_->Clear();
    Await("commands on the bus", [&] { return ArmedAndMoving(); });
    std::this_thread::sleep_for(after);
    const testing::Witness witness;
    commander.Signal(SIGKILL);
    Await("the fault", [&] { return watcher_->seen().idle_ns != 0; });
    const Watcher::Seen seen = watcher_->seen();
    if (seen.damping_ns == 0 && !seen.watchdog) {
      const std::string log = programs_.back()->error();
      throw std::runtime_error("a fault without damping before it\n" +
                               log.substr(log.size() - std::min<std::size_t>(log.size(), 800)));
    }
    (void)commander.Wait(seconds(5));
    while (commands_.TakeNext()) {
    }
    if (seen.watchdog) return std::nullopt;
    return Times{1e-6 * static_cast<double>(seen.damping_ns - seen.fresh_ns),
                 1e-6 * static_cast<double>(seen.idle_ns - seen.fresh_ns), start_ms,
                 witness.Latest_ms()};
  }

  // The longest time without a new command on the bus when the owner dies beside a standby.
  struct TakeOver {
    double gap_ms = 0.0, witness_ms = 0.0;
  };
  TakeOver KillBesideStandby(milliseconds after) {
    while (controllers_.size() < 2) {
      controllers_.push_back(std::make_unique<Program>(Arguments(
          {self_, "--commander", "--name", "commander_" + std::to_string(started_++)}, place_)));
      if (controllers_.size() == 1) {
        Await("commands on the bus", [&] { return ArmedAndMoving(); });
      }
    }
    Await("an owner and one that stands by", [&] { return OneOwnerAndOneBelow(); });
    std::this_thread::sleep_for(after);
    watcher_->Clear();
    Await("commands on the bus", [&] { return watcher_->seen().fresh > 5; });
    const testing::Witness witness;
    const std::int64_t kill_ns = types::MonotonicNow_ns();
    controllers_.front()->Signal(SIGKILL);
    (void)controllers_.front()->Wait(seconds(5));
    controllers_.erase(controllers_.begin());
    Await("commands after the kill", [&] {
      const Watcher::Seen seen = watcher_->seen();
      return seen.idle_ns != 0 || types::MonotonicNow_ns() - kill_ns > 150'000'000;
    });
    const Watcher::Seen seen = watcher_->seen();
    if (seen.idle_ns != 0) throw std::runtime_error("a fault beside a standby");
    return {1e-6 * static_cast<double>(seen.gap_ns), witness.Latest_ms()};
  }

 private:
  // As their announcements say: the first controller above the other, both settled.
  bool OneOwnerAndOneBelow() {
    std::uint32_t owner = 0, below = 0;
    for (const node::Endpoint& endpoint : node_.Endpoints()) {
      if (!endpoint.is_writer || endpoint.topic != node::kJointCommand.name) continue;
      const bool newest = endpoint.participant == "commander_" + std::to_string(started_ - 1);
      (newest ? below : owner) = endpoint.strength;
    }
    return below > 1 && owner > below;
  }

  bool ArmedAndMoving() {
    while (const auto state = states_.TakeNext()) last_ = *state;
    const bool fault = last_.robot_state == msg::RobotState::kFault;
    if (fault) watcher_->Clear();
    if (fault || last_.robot_state == msg::RobotState::kDisarmed) {
      if (++asked_ % 20 == 1) {
        msg::OperatorCommand command;
        command.header = last_.header;
        command.action = fault ? msg::OperatorAction::kReset : msg::OperatorAction::kArm;
        (void)operator_.Write(command);
      }
      return false;
    }
    asked_ = 0;
    return watcher_->seen().fresh > 5;
  }

  template <class Done>
  void Await(const char* what, Done done) {
    asked_ = 0;
    const auto give_up = std::chrono::steady_clock::now() + seconds(20);
    while (!done()) {
      if (std::chrono::steady_clock::now() > give_up) {
        throw std::runtime_error(std::string("waited 20 s in vain for ") + what + "\n" +
                                 programs_.back()->error());
      }
      node_.WaitForData(milliseconds(5));
    }
  }

  std::string self_;
  Place place_;
  testing::TemporaryFolder folder_;
  std::vector<std::unique_ptr<Program>> programs_;
  std::vector<std::unique_ptr<Program>> controllers_;  // the owner, and who stands by
  int started_ = 0;
  std::unique_ptr<Watcher> watcher_;
  node::Node node_;
  node::Reader<msg::JointState> states_ = node_.MakeReader(node::kJointState);
  node::Reader<msg::JointCommand> commands_ = node_.MakeReader(node::kJointCommand);
  node::Writer<msg::OperatorCommand> operator_ = node_.MakeWriter(node::kOperatorCommand);
  msg::JointState last_;
  bool received_ = false;
  int asked_ = 0;
};

struct Measured {
  double value_ms, witness_ms;
};

constexpr double kWitnessGoal_ms = 1.0;

void PrintTimes(const char* what, const std::vector<Measured>& measured, double goal_ms = 0.0) {
  std::vector<double> values_ms;
  values_ms.reserve(measured.size());
  int late = 0, late_machine = 0, disturbed = 0;
  for (const Measured& one : measured) {
    values_ms.push_back(one.value_ms);
    const bool machine = one.witness_ms > kWitnessGoal_ms;
    disturbed += machine ? 1 : 0;
    if (one.value_ms > goal_ms) ++(machine ? late_machine : late);
  }
  std::sort(values_ms.begin(), values_ms.end());
  const auto at = [&](double share) {
    return values_ms[static_cast<std::size_t>(share * static_cast<double>(values_ms.size() - 1))];
  };
  std::printf("%-28s median %7.2f  99 %% %7.2f  worst %7.2f ms", what, at(0.5), at(0.99),
              values_ms.back());
  if (goal_ms > 0.0) {
    std::printf("   goal %6.2f ms, later %d of %zu; %d more while the machine was late itself (%d)",
                goal_ms, late, values_ms.size(), late_machine, disturbed);
  }
  std::printf("\n");
}

// One busy process a core, at the lowest priority that the other programs of a machine have.
class Load {
 public:
  Load() {
    for (unsigned k = 0; k < std::thread::hardware_concurrency(); ++k) {
      busy_.push_back(std::make_unique<Program>(
          std::vector<std::string>{"/bin/sh", "-c", "while :; do :; done"}));
    }
  }

 private:
  std::vector<std::unique_ptr<Program>> busy_;
};

void MeasureTakeOvers(Bench* bench, int kills, double period_ms) {
  std::mt19937 random(1);
  std::vector<Measured> gaps;
  for (int k = 1; k <= kills; ++k) {
    const auto [gap_ms, witness_ms] =
        bench->KillBesideStandby(milliseconds(20 + static_cast<int>(random() % 100)));
    gaps.push_back({gap_ms, witness_ms});
    if (k % 100 == 0) std::fprintf(stderr, "%d of %d\n", k, kills);
  }
  std::printf("%d kills beside a standby, period %.2f ms\n", kills, period_ms);
  PrintTimes("command to command", gaps, 35.0);
}

void MeasureFaults(Bench* bench, int kills, double period_ms) {
  std::mt19937 random(1);
  std::vector<Measured> damping, fault, start;
  int stood_still = 0;
  for (int k = 0; k < kills;) {
    const auto times = bench->Kill(milliseconds(20 + static_cast<int>(random() % 100)));
    if (!times) {
      if (++stood_still > kills / 10 + 1) {
        throw std::runtime_error("the machine stands still too often");
      }
      continue;
    }
    damping.push_back({times->damping_ms, times->witness_ms});
    fault.push_back({times->fault_ms, times->witness_ms});
    start.push_back({times->start_ms, times->witness_ms});
    if (++k % 100 == 0) std::fprintf(stderr, "%d of %d\n", k, kills);
  }
  std::printf("%d kills, period %.2f ms; %d more in which the axis' own watchdog was first\n",
              kills, period_ms, stood_still);
  PrintTimes("last command to damping", damping, 4.0 * period_ms);
  PrintTimes("last command to the fault", fault, 60.0 + period_ms);
  PrintTimes("start to the first command", start);
}

int Main(int argc, char** argv) {
  int kills = 1000;
  Place place;
  double rate_Hz = 240.0;
  bool commander = false, standby = false, loaded = false;
  std::string name = "commander";
  CLI::App app("Kills the controller and measures what the bridge does on the bus");
  app.add_option("--kills", kills, "How often")->capture_default_str();
  app.add_option("--rate", rate_Hz, "Cycles per second of the bridge")->capture_default_str();
  app.add_option("--domain", place.domain, "DDS domain")->capture_default_str();
  app.add_option("--qos", place.qos, "XML file with QoS profiles instead of the built-in ones");
  app.add_flag("--realtime", place.realtime, "All processes under SCHED_FIFO");
  app.add_flag("--standby", standby, "Another controller stands by: measure how it takes over");
  app.add_flag("--load", loaded, "One busy process a core beside it");
  app.add_flag("--commander", commander, "Be the controller that is killed");
  app.add_option("--name", name, "Of that controller");
  CLI11_PARSE(app, argc, argv);
  if (commander) return Command(place, name);

  const double period_ms = 1e3 / rate_Hz;
  Bench bench(std::filesystem::read_symlink("/proc/self/exe").string(), place, rate_Hz);
  std::optional<Load> load;
  if (loaded) load.emplace();
  if (standby) {
    MeasureTakeOvers(&bench, kills, period_ms);
  } else {
    MeasureFaults(&bench, kills, period_ms);
  }
  return 0;
}

}  // namespace
}  // namespace sinew

int main(int argc, char** argv) {
  try {
    return sinew::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "watchdog_kills: %s\n", error.what());
    return 1;
  }
}

// From a press of the estop to the idle frame on the bus; README.md.
#include <fcntl.h>
#include <linux/joystick.h>
#include <sched.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <functional>
#include <future>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include "components/robot/estop/press.h"
#include "tests/bridge/participant/can_rig.h"
#include "tests/support/test_host.h"

namespace sinew {
namespace {

constexpr double kPressGoal_ms = 20.0;
constexpr double kOneShotGoal_ms = 1000.0;

// The end of a log.
std::string Last(const std::string& log) {
  return log.substr(log.size() - std::min<std::size_t>(log.size(), 1500));
}

class Bench {
 public:
  Bench(int domain, std::vector<std::string> bridge_arguments, bool realtime)
      : domain_(std::to_string(domain)),
        rig_(domain, {.bridge_more = "estop: {socket: estop.sock, latch: estop.latch}\n",
                      .bridge_arguments = std::move(bridge_arguments),
                      .realtime = realtime}),
        realtime_(realtime),
        watch_(rig_),
        socket_((rig_.folder() / "estop.sock").string()),
        device_((rig_.folder() / "js0").string()) {
    if (::mkfifo(device_.c_str(), 0600) != 0) throw std::runtime_error("no FIFO");
    stick_ = ::open(device_.c_str(), O_RDWR | O_CLOEXEC);
  }
  ~Bench() { ::close(stick_); }

  // Presses at any moment of a cycle; the times to the idle frame.
  template <class Action>
  std::vector<double> Press(
      int count, Action press, const std::function<void()>& finish = [] {}) {
    std::vector<double> took_ms;
    for (int k = 0; k < count; ++k) {
      if (!rig_.Arm() || !rig_.Run(0.001, seconds(15), [&](const msg::JointState& s) {
            return s.robot_state == msg::RobotState::kArmed && watch_.InClosedLoop();
          })) {
        throw std::runtime_error("not armed\n" + Last(rig_.bridge().error()));
      }
      std::this_thread::sleep_for(std::chrono::microseconds(random_() % 5000));
      const std::int64_t pressed_ns = types::MonotonicNow_ns();
      press();
      const auto idle_ms = watch_.IdleAfter(pressed_ns);
      if (!idle_ms) throw std::runtime_error("no idle frame\n" + Last(rig_.bridge().error()));
      took_ms.push_back(*idle_ms);
      finish();
      Release();
      // Until everybody has heard that the robot has stopped.
      if (!rig_.Run(0.0, seconds(15), [&, n = 0](const msg::JointState& s) mutable {
            return s.robot_state == msg::RobotState::kEstopped && ++n > 5;
          })) {
        throw std::runtime_error("not estopped\n" + Last(rig_.bridge().error()));
      }
      if (!rig_.Order(msg::OperatorAction::kReset, msg::RobotState::kDisarmed)) {
        throw std::runtime_error("no reset\n" + Last(rig_.bridge().error()));
      }
    }
    return took_ms;
  }

  void PressSocket() { (void)estop::Press(socket_, "bench"); }
  void PressButton() { Button(1); }
  void Release() { Button(0); }
  // With this socket; another DDS domain than the bridge's leaves the socket alone.
  std::unique_ptr<Program> Resident(const std::string& domain, const std::string& socket) {
    std::vector<std::string> arguments = {std::string(SINEW_BIN_DIR) + "/sinew-estop"};
    arguments.insert(arguments.end(),
                     {"--domain", domain, "--joystick", device_, "--socket", socket});
    if (realtime_) arguments.push_back("--realtime");
    auto program = std::make_unique<Program>(arguments);
    if (!program->WaitForText("watches", seconds(10))) throw std::runtime_error(program->error());
    // Until DDS has found its peers.
    (void)rig_.Run(0.0, seconds(2), [](const msg::JointState&) { return false; });
    return program;
  }
  const std::string& domain() const { return domain_; }
  const std::string& socket() const { return socket_; }

 private:
  void Button(int value) {
    js_event event{};
    event.type = JS_EVENT_BUTTON;
    event.value = static_cast<__s16>(value);
    if (::write(stick_, &event, sizeof event) != static_cast<ssize_t>(sizeof event)) {
      throw std::runtime_error("the FIFO is full");
    }
  }

  std::string domain_;
  Rig rig_;
  bool realtime_;
  AxisWatch watch_;
  std::string socket_, device_;
  int stick_ = -1;
  std::mt19937 random_{1};
};

// This program and what it starts move to the first of two hosts; call it before the first thread.
void MoveToFirst(const testing::TwoHosts& hosts) {
  if (!hosts.why_not().empty()) throw std::runtime_error("no two hosts: " + hosts.why_not());
  const std::string path = "/proc/" + std::to_string(hosts.pid(0)) + "/ns/net";
  const int space = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const int result = ::setns(space, CLONE_NEWNET);
  ::close(space);
  if (result != 0) throw std::runtime_error(path + " cannot be entered");
}

// False: the 99th percentile is beyond the goal.
bool PrintPresses(const char* what, std::vector<double> values_ms, double goal_ms) {
  if (values_ms.empty()) return true;
  std::sort(values_ms.begin(), values_ms.end());
  const auto at = [&](double share) {
    return values_ms[static_cast<std::size_t>(share * static_cast<double>(values_ms.size() - 1))];
  };
  std::printf("%-28s %4zu presses  median %8.2f  99 %% %8.2f  worst %8.2f ms  goal %g ms\n", what,
              values_ms.size(), at(0.5), at(0.99), values_ms.back(), goal_ms);
  return at(0.99) <= goal_ms;
}

int Main(int argc, char** argv) {
  int presses = 300, one_shots = 50, domain = 47;
  std::string rate = "240";
  bool realtime = false, two_hosts = false;
  CLI::App app("Presses the estop and measures when the axis is idled");
  app.add_option("--presses", presses, "Of each resident way")->capture_default_str();
  app.add_option("--one-shots", one_shots, "Of the command")->capture_default_str();
  app.add_option("--rate", rate, "Cycles per second of the bridge")->capture_default_str();
  app.add_option("--domain", domain, "DDS domain; the next one is used, too")
      ->capture_default_str();
  app.add_flag("--realtime", realtime, "Everything resident under SCHED_FIFO, this program too");
  app.add_flag("--two-hosts", two_hosts, "The command on another host, as network namespaces");
  CLI11_PARSE(app, argc, argv);

  std::optional<testing::TwoHosts> hosts;
  std::vector<std::string> bridge_arguments = {"--rate", rate};
  if (two_hosts) {
    MoveToFirst(hosts.emplace());
    bridge_arguments.insert(bridge_arguments.end(), {"--interface", "wire0"});
  }

  if (realtime) {  // not what it starts: these ask for themselves
    sched_param parameters{};
    parameters.sched_priority = 49;
    if (::sched_setscheduler(0, SCHED_FIFO | SCHED_RESET_ON_FORK, &parameters) != 0) {
      throw std::runtime_error("SCHED_FIFO is refused");
    }
  }
  Bench bench(domain, bridge_arguments, realtime);
  const std::string nowhere = "/nonexistent/estop.sock";
  std::printf("%s Hz\n", rate.c_str());
  bool good =
      PrintPresses("socket", bench.Press(presses, [&] { bench.PressSocket(); }), kPressGoal_ms);
  {
    const auto resident = bench.Resident(std::to_string(domain + 1), bench.socket());
    good = PrintPresses("button by the socket", bench.Press(presses, [&] { bench.PressButton(); }),
                        kPressGoal_ms) &&
           good;
    resident->Signal(SIGTERM);
    (void)resident->Wait(seconds(10));
  }
  {
    const auto resident = bench.Resident(bench.domain(), nowhere);
    good = PrintPresses("button by DDS", bench.Press(presses, [&] { bench.PressButton(); }),
                        kPressGoal_ms) &&
           good;
    resident->Signal(SIGTERM);
    (void)resident->Wait(seconds(10));
  }
  // Beside the reading of the bus, whose queue here holds less than a second.
  std::vector<double> command_ms;
  std::future<testing::Finished> command;
  std::int64_t begin_ns = 0;
  const auto one_shot = [&] {
    begin_ns = types::MonotonicNow_ns();
    command = std::async(std::launch::async, [&] {
      std::vector<std::string> line = {std::string(SINEW_BIN_DIR) + "/sinew",
                                       "estop",
                                       "--domain",
                                       bench.domain(),
                                       "--socket",
                                       nowhere};
      if (!hosts) return testing::Run(line);
      line.insert(line.end(), {"--interface", "wire0"});
      return testing::Run(hosts->On(1, line));
    });
  };
  const auto finish = [&] {
    const testing::Finished run = command.get();
    if (run.exit_code != 0) throw std::runtime_error("sinew estop: " + run.error);
    command_ms.push_back(1e-6 * static_cast<double>(types::MonotonicNow_ns() - begin_ns));
  };
  good =
      PrintPresses("one-shot by DDS", bench.Press(one_shots, one_shot, finish), kOneShotGoal_ms) &&
      good;
  good = PrintPresses("one-shot, to its end", command_ms, kOneShotGoal_ms) && good;
  return good ? 0 : 1;
}

}  // namespace
}  // namespace sinew

int main(int argc, char** argv) {
  try {
    return sinew::Main(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "estop_bench: %s\n", error.what());
    return 1;
  }
}

// sinew-estop: waits for a person's button and stops the robot, by the socket of this host and by
// DDS.
#include <poll.h>
#include <sinew_idl/estop.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/base/types/clock/clock.h"
#include "components/robot/estop/assertion.h"
#include "components/robot/estop/inputs.h"
#include "components/robot/estop/press.h"
#include "components/robot/estop/socket_folder.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"
#include "components/topics/node/realtime.h"

namespace {

using namespace sinew;
using std::chrono::milliseconds;

constexpr milliseconds kStateAge(200);   // older: nobody says that the robot has stopped
constexpr milliseconds kEndLimit(1000);  // for the confirmation of a last press
constexpr milliseconds kReopen(500);     // between attempts to find a lost device again
constexpr milliseconds kBeat(50);        // period of the heartbeat
constexpr milliseconds kThreadAge(150);  // older: the inputs' thread hangs, and nothing is said

struct EstopOptions {
  std::vector<std::string> joysticks, lines, sockets;
  int button = 0;
  bool keys = false;
  std::string reason;
};

// A thread that waits for the inputs and presses the sockets itself, whatever DDS does meanwhile.
class InputThread {
 public:
  struct Socket {
    std::string path;
    estop::Press press;
  };

  InputThread(std::vector<std::unique_ptr<estop::Input>> inputs,
              std::function<std::vector<std::filesystem::path>()> sockets,
              std::function<void()> wake)
      : inputs_(std::move(inputs)), sockets_(std::move(sockets)), wake_(std::move(wake)) {
    for (const auto& input : inputs_) {
      if (input->stops()) Stop(*input);
    }
    thread_ = std::thread([this] { Run(); });
  }
  ~InputThread() {
    stop_ = true;
    thread_.join();
  }

  struct Pressed {
    std::string reason;
    std::vector<Socket> sockets;  // pressed already; their answers are to come
  };
  // A press since the last call.
  std::optional<Pressed> TakePress() {
    const std::lock_guard lock(mutex_);
    return std::exchange(press_, std::nullopt);
  }
  // Text of an input that stops now. Empty: none.
  std::string Stopping() {
    const std::lock_guard lock(mutex_);
    return stopping_;
  }
  // It has looked at its inputs lately.
  bool alive(std::int64_t now_ns) const {
    return now_ns - looked_ns_ < std::chrono::nanoseconds(kThreadAge).count();
  }
  struct Answers {
    bool idle = false;  // the state providers of this host, and there is one, report idle
    std::string text;
  };
  static Answers Await(std::vector<Socket> pressed) {
    Answers answers;
    for (Socket& socket : pressed) {
      if (!socket.press.sent()) continue;
      const estop::Press::Answer answer = socket.press.Await(estop::kAnswerLimit);
      answers.idle = answer.idle && (answers.text.empty() || answers.idle);
      answers.text +=
          socket.path + ": " + (answer.text.empty() ? std::string("no answer\n") : answer.text);
    }
    std::replace(answers.text.begin(), answers.text.end(), '\n', ' ');
    return answers;
  }
  std::vector<Socket> PressSockets(const std::string& reason) const {
    std::vector<Socket> pressed;
    for (const auto& path : sockets_()) pressed.push_back({path.string(), {path, reason}});
    return pressed;
  }

 private:
  void Run() {
    std::vector<pollfd> waiting;
    while (!stop_) {
      waiting.clear();
      for (const auto& input : inputs_) waiting.push_back({input->descriptor(), POLLIN, 0});
      (void)::poll(waiting.data(), waiting.size(), static_cast<int>(kBeat.count()));
      for (const auto& input : inputs_) {
        if (input->Read()) Stop(*input);
      }
      ReopenLost();
      Note();
      looked_ns_ = types::MonotonicNow_ns();
    }
  }

  // Sends and goes on reading: the loop waits for the answers.
  void Stop(const estop::Input& input) {
    const std::string reason = input.lost() ? input.why() : input.name();
    std::vector<Socket> pressed = PressSockets(reason);
    {
      const std::lock_guard lock(mutex_);
      press_ = {reason, std::move(pressed)};
    }
    Note();
    wake_();
    spdlog::warn("estop: {}", reason);
  }

  void ReopenLost() {
    const std::int64_t now_ns = types::MonotonicNow_ns();
    if (now_ns < reopen_ns_) return;
    reopen_ns_ = now_ns + std::chrono::nanoseconds(kReopen).count();
    for (const auto& input : inputs_) {
      if (!input->lost() || !input->Reopen()) continue;
      spdlog::info("input {} is there again", input->name());
      if (input->stops()) Stop(*input);
    }
  }

  void Note() {
    const auto stops = std::find_if(inputs_.begin(), inputs_.end(),
                                    [](const auto& input) { return input->stops(); });
    const std::lock_guard lock(mutex_);
    stopping_ = stops == inputs_.end() ? ""
                : (*stops)->lost()     ? "lost: " + (*stops)->why()
                                       : "held: " + (*stops)->name();
  }

  std::vector<std::unique_ptr<estop::Input>> inputs_;
  std::function<std::vector<std::filesystem::path>()> sockets_;
  std::function<void()> wake_;
  std::atomic<bool> stop_{false};
  std::atomic<std::int64_t> looked_ns_{0};
  std::int64_t reopen_ns_ = 0;
  std::mutex mutex_;
  std::optional<Pressed> press_;
  std::string stopping_;
  std::thread thread_;
};

std::vector<std::unique_ptr<estop::Input>> OpenInputs(const EstopOptions& options) {
  std::vector<std::unique_ptr<estop::Input>> inputs;
  for (const std::string& device : options.joysticks) {
    inputs.push_back(estop::OpenJoystick(device, options.button));
  }
  for (const std::string& line : options.lines) inputs.push_back(estop::OpenGpio(line));
  if (options.keys) inputs.push_back(estop::OpenKeys());
  if (inputs.empty()) {
    throw UsageError("no input: --keyboard, --joystick DEVICE or --gpio CHIP:LINE is expected");
  }
  return inputs;
}

msg::EstopState Heartbeat(const std::string& name, const std::string& stopping,
                          const msg::JointState& state) {
  msg::EstopState beat;
  beat.header = state.header;
  beat.name = name;
  beat.stops = !stopping.empty();
  beat.why = stopping.substr(0, 127);
  return beat;
}

void Run(const node::Options& options, node::StopFlag& stop, const EstopOptions& estop_options) {
  std::vector<std::unique_ptr<estop::Input>> inputs = OpenInputs(estop_options);
  const auto sockets = [&] {  // at each press anew: bridges come and go
    return estop::SocketsToPress({estop_options.sockets.begin(), estop_options.sockets.end()},
                                 options.chosen_domain);
  };
  std::string names;
  for (const auto& input : inputs) names += (names.empty() ? "" : "; ") + input->name();

  node::Node node(options);
  auto states = node.MakeReader(node::kJointState);
  auto commands = node.MakeWriter(node::kOperatorCommand);
  auto beats = node.MakeWriter(node::kEstopState);
  InputThread thread(std::move(inputs), sockets, [&node] { node.Wake(); });
  spdlog::info("watches {}", names);

  estop::Assertion assertion;
  std::optional<msg::JointState> state;
  InputThread::Pressed press;  // the last one
  std::string reported = "?";
  node::Node::Counts counts;
  std::int64_t heard_ns = 0, beat_ns = 0;
  bool idled = false;  // by the socket, since the last press
  std::optional<std::int64_t> end_ns;
  node::BeginRealtime();
  for (;;) {
    if (stop.requested() && !end_ns) {
      end_ns = types::MonotonicNow_ns() + std::chrono::nanoseconds(kEndLimit).count();
      // Ctrl-C is a key as well, and a keyboard that nobody watches any more is a lost input.
      if (estop_options.keys) {
        press.reason = "sinew-estop ends";
        assertion.Press();
      }
    }
    const std::int64_t now_ns = types::MonotonicNow_ns();
    bool stopped = false;
    while (auto next = states.TakeNext()) {  // ESTOPPED may last no longer than a cycle
      stopped = stopped || next->robot_state == msg::RobotState::kEstopped;
      state = next;
      heard_ns = now_ns;
    }
    if (auto taken = thread.TakePress()) {
      press = std::move(*taken);
      assertion.Press();
      idled = false;
    }
    const std::string stopping = thread.Stopping();
    if (!stopping.empty() && !assertion.pressed()) press.reason = stopping;
    if (state && !end_ns && thread.alive(now_ns) &&
        now_ns - beat_ns >= std::chrono::nanoseconds(kBeat).count()) {
      beat_ns = now_ns;
      const msg::EstopState beat = Heartbeat(options.name, stopping, *state);
      if (beats.Write(beat) != node::WriteStatus::kOk) ++counts.write_failures;
    }
    const bool heard = state && now_ns - heard_ns < std::chrono::nanoseconds(kStateAge).count();
    stopped = stopped || (heard && state->robot_state == msg::RobotState::kEstopped);
    if (!heard && idled) assertion.Confirm();  // without DDS the socket's answer counts
    if (assertion.Due(!stopping.empty(), stopped, now_ns)) {
      msg::OperatorCommand command;
      if (state) command.header = state->header;
      command.action = msg::OperatorAction::kEstop;
      command.reason = press.reason.substr(0, 63);
      if (commands.Write(command) != node::WriteStatus::kOk) ++counts.write_failures;
      const InputThread::Answers answers =
          InputThread::Await(press.sockets.empty() ? thread.PressSockets(press.reason)
                                                   : std::exchange(press.sockets, {}));
      if (!idled && !answers.text.empty()) spdlog::info("{}", answers.text);
      idled = answers.idle;
      ++counts.cycles;
    }
    const std::string message = assertion.pressed() ? "estop sent, not confirmed yet" : stopping;
    if (std::exchange(reported, message) != message) {
      node.SetState(message.empty() ? node::Node::State::kActive : node::Node::State::kFault,
                    message.empty() ? "watches its inputs" : message);
    }
    node.SetCounts(counts);
    if (end_ns && (!assertion.pressed() || now_ns >= *end_ns)) break;
    node.WaitForData(kBeat);
  }
}

}  // namespace

int main(int argc, char** argv) {
  EstopOptions estop_options;
  return node::RunParticipant(
      argc, argv, "estop", "Waits for a button, a line or a key and stops the robot.",
      [&](const node::Options& options, node::StopFlag& stop) {
        Run(options, stop, estop_options);
      },
      [&](CLI::App& app) {
        app.add_option("--joystick", estop_options.joysticks,
                       "Device such as /dev/input/js0; may be repeated");
        app.add_option("--button", estop_options.button, "Button of the joysticks, counted from 0")
            ->check(CLI::Range(0, 255))
            ->capture_default_str();
        app.add_option("--gpio", estop_options.lines,
                       "CHIP:LINE such as /dev/gpiochip0:17, low stops; CHIP:LINE:high: high "
                       "stops; may be repeated");
        app.add_flag("--keyboard", estop_options.keys,
                     "Any key on the terminal, and the end of this program");
        app.add_option(
            "--socket", estop_options.sockets,
            "Sockets of state providers on this host; by default all of them, or those of "
            "--domain");
      });
}

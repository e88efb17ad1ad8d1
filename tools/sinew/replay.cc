#include <poll.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "components/base/types/json_text.h"
#include "components/base/types/text.h"
#include "components/record/logger/player/participant/play.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/replay_screen.h"

namespace sinew::tools {

namespace {

// For the signal handlers, which have no object: set before they are installed.
termios terminal_before{};
termios terminal_keys{};
std::atomic<bool> terminal_changed{false};

constexpr std::array kFatalSignals = {SIGHUP, SIGQUIT, SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};

bool InForeground() { return ::tcgetpgrp(STDIN_FILENO) == ::getpgrp(); }

// Async-signal-safe, as tcsetattr, tcgetpgrp and getpgrp are (POSIX.1-2017, 2.4.3). A process in
// the background would be stopped by setting the terminal.
void RestoreTerminal() {
  if (terminal_changed.load() && InForeground()) {
    (void)::tcsetattr(STDIN_FILENO, TCSANOW, &terminal_before);
  }
}

void SetTerminal() {
  if (terminal_changed.load() && InForeground()) {
    (void)::tcsetattr(STDIN_FILENO, TCSANOW, &terminal_keys);
  }
}

void OnFatal(int signal) {
  RestoreTerminal();
  (void)std::signal(signal, SIG_DFL);
  (void)::raise(signal);
}

void OnStop(int) {
  RestoreTerminal();
  (void)::raise(SIGSTOP);
}

void OnContinue(int) { SetTerminal(); }

void Install(int signal, void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  (void)::sigaction(signal, &action, nullptr);
}

// Single keys from the terminal, without echo; the terminal is as before at every end of the
// process.
//
// Ctrl-C and Ctrl-Z keep their meaning. What restores the terminal: the destructor, exit(), the
// fatal signals, and a stop (Ctrl-Z; the next SIGCONT in the foreground sets it again). Only
// SIGKILL cannot be caught. One object at a time.
class TerminalKeys {
 public:
  // Without a terminal on standard input, or in the background, it does nothing. `on_byte` is
  // called by a thread of its own.
  explicit TerminalKeys(std::function<void(char)> on_byte) : on_byte_(std::move(on_byte)) {
    if (::isatty(STDIN_FILENO) != 1 || !InForeground()) return;
    if (::tcgetattr(STDIN_FILENO, &terminal_before) != 0) return;
    terminal_keys = terminal_before;
    terminal_keys.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
    terminal_keys.c_cc[VMIN] = 1;
    terminal_keys.c_cc[VTIME] = 0;
    static const bool kAtExit = std::atexit(RestoreTerminal) == 0;
    if (!kAtExit) return;
    for (const int signal : kFatalSignals) Install(signal, OnFatal);
    Install(SIGTSTP, OnStop);
    Install(SIGCONT, OnContinue);
    terminal_changed = true;
    SetTerminal();
    active_ = true;
    stop_ = ::eventfd(0, EFD_CLOEXEC);
    thread_ = std::thread([this] { Run(); });
  }
  ~TerminalKeys() {
    if (!active_) return;
    const std::uint64_t one = 1;
    (void)!::write(stop_, &one, sizeof one);
    thread_.join();
    ::close(stop_);
    RestoreTerminal();
    terminal_changed = false;
  }
  TerminalKeys(const TerminalKeys&) = delete;
  TerminalKeys& operator=(const TerminalKeys&) = delete;

 private:
  void Run() {
    for (;;) {
      std::array<pollfd, 2> waiting{{{stop_, POLLIN, 0}, {STDIN_FILENO, POLLIN, 0}}};
      (void)::poll(waiting.data(), waiting.size(), -1);
      if (waiting[0].revents != 0) return;
      if (!InForeground()) {  // the keys are the shell's: reading would stop the process
        pollfd stop{stop_, POLLIN, 0};
        if (::poll(&stop, 1, 200) > 0) return;
        continue;
      }
      std::array<char, 16> bytes{};
      const ssize_t size = ::read(STDIN_FILENO, bytes.data(), bytes.size());
      if (size <= 0) {  // the terminal is gone
        pollfd stop{stop_, POLLIN, 0};
        (void)::poll(&stop, 1, -1);
        return;
      }
      for (ssize_t i = 0; i < size; ++i) on_byte_(bytes[static_cast<std::size_t>(i)]);
    }
  }

  const std::function<void(char)> on_byte_;
  bool active_ = false;
  int stop_ = -1;
  std::thread thread_;
};

// The keys and the line, each only where there is a terminal.
class ReplayScreen {
 public:
  explicit ReplayScreen(logger::PlayControl& control)
      : visible_(::isatty(STDERR_FILENO) == 1), keys_([this, &control](char byte) {
          const std::optional<std::string> request = decoder_.Take(byte);
          if (request) control.Post(logger::ParsePlayRequest(*request));
        }) {}
  ~ReplayScreen() { Finish(); }
  ReplayScreen(const ReplayScreen&) = delete;
  ReplayScreen& operator=(const ReplayScreen&) = delete;

  void Show(const logger::PlayStatus& status) {
    if (!visible_) return;
    const auto columns = static_cast<std::size_t>(SizeOfTerminal(STDERR_FILENO).columns);
    Unfiltered(std::cerr) << "\r\x1b[K" << ReplayLine(status, columns - 1) << std::flush;
    drawn_ = true;
  }
  void Finish() {
    if (drawn_) Unfiltered(std::cerr) << "\r\x1b[K" << std::flush;
    drawn_ = false;
  }

 private:
  const bool visible_;
  bool drawn_ = false;
  KeyDecoder decoder_;  // of the keys' thread
  TerminalKeys keys_;
};

}  // namespace

void AddReplayCommand(CLI::App& app) {
  struct Options {
    node::Options node;
    logger::PlayOptions play;
    bool json = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("replay", "Send the topics of a recording into a domain");
  AddNodeOptions(*command, &options->node);
  command
      ->add_option("--name", options->node.name,
                   "Participant name, by which replay-control reaches it")
      ->capture_default_str();
  logger::AddPlayOptions(*command, &options->play);
  command->add_flag("--json", options->json, "Result as JSON");
  command->footer(
      "Messages are marked as replay: live hardware moves by none of them but a reference that an "
      "operator\n"
      "permits (sinew permit-replay). With joint_state among "
      "the topics\n"
      "replay is the state provider; without it, it can stand in for others (--follow). In "
      "lockstep nothing\n"
      "is lost, and it runs as fast as the readers take it. Keys on a terminal: space pauses, s "
      "steps a tick, left\n"
      "and right seek 5 s, down and up 60 s, + and - change the rate, q ends; from elsewhere: "
      "sinew replay-control.\n"
      "A seek and each loop begin a new session.\n\nExamples:\n"
      "  sinew replay run.mcap --rate 2 --loop 0\n"
      "  sinew replay run.mcap --rate max --topics '.*_state' --exclude reservoir_state\n"
      "  sinew replay run.mcap --paused --name bench\n"
      "  sinew replay run.mcap --lockstep --wait-readers 1\n"
      "  sinew replay run.mcap --topics reference --follow");
  command->callback([options] {
    node::StopFlag stop;
    node::Node node(options->node);
    logger::PlayControl control;
    ReplayScreen screen(control);
    const logger::PlayResult result =
        logger::Play(node, stop, options->play, control,
                     [&screen](const logger::PlayResult& now) { screen.Show(now.status); });
    screen.Finish();
    if (options->json) {
      std::cout << types::JsonText(nlohmann::ordered_json{{"file", options->play.path.string()},
                                                          {"messages", result.messages},
                                                          {"of", result.message_count},
                                                          {"write_failures", result.write_failures},
                                                          {"recorded_s", result.recorded_s},
                                                          {"wall_s", result.wall_s}})
                << '\n';
    } else {
      std::cout << options->play.path.string() << ": " << result.messages << " of "
                << result.message_count << " messages, "
                << types::Text("%.1f s in %.1f s", result.recorded_s, result.wall_s) << '\n';
    }
    if (result.write_failures > 0) {
      std::cerr << "sinew replay: " << result.write_failures << " messages could not be sent\n";
      throw CLI::RuntimeError(1);
    }
  });
}

}  // namespace sinew::tools

#include "tools/sinew/terminal_keys.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <utility>

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

}  // namespace

TerminalKeys::TerminalKeys(std::function<void(char)> on_byte) : on_byte_(std::move(on_byte)) {
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

TerminalKeys::~TerminalKeys() {
  if (!active_) return;
  const std::uint64_t one = 1;
  (void)!::write(stop_, &one, sizeof one);
  thread_.join();
  ::close(stop_);
  RestoreTerminal();
  terminal_changed = false;
}

void TerminalKeys::Run() {
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

}  // namespace sinew::tools

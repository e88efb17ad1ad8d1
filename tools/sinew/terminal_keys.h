// Single keys from the terminal, without echo; the terminal is as before at every end of the
// process.
//
// Ctrl-C and Ctrl-Z keep their meaning. What restores the terminal: the destructor, exit(), the
// fatal signals, and a stop (Ctrl-Z; the next SIGCONT in the foreground sets it again). Only
// SIGKILL cannot be caught. One object at a time.
#pragma once

#include <functional>
#include <thread>

namespace sinew::tools {

class TerminalKeys {
 public:
  // Without a terminal on standard input, or in the background, it does nothing. `on_byte` is
  // called by a thread of its own.
  explicit TerminalKeys(std::function<void(char)> on_byte);
  ~TerminalKeys();
  TerminalKeys(const TerminalKeys&) = delete;
  TerminalKeys& operator=(const TerminalKeys&) = delete;

  bool active() const { return active_; }

 private:
  void Run();

  const std::function<void(char)> on_byte_;
  bool active_ = false;
  int stop_ = -1;
  std::thread thread_;
};

}  // namespace sinew::tools

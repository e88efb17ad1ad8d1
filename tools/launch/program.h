// A program under test as a child process: its output, signals to it, its end, all within a limit.
//
// The child dies with the thread that started it. One thread; a helper thread of its own collects
// the output. Throws std::runtime_error where the system gives no pipe or process.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace sinew::launch {

class Program {
 public:
  // Starts arguments[0] (looked up in PATH when it has no slash), in no isolated deployment unless
  // its arguments name one.
  explicit Program(const std::vector<std::string>& arguments, const std::string& folder = "");
  ~Program();  // kills it if it still runs
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  // True as soon as output or error output holds the text.
  bool WaitForText(const std::string& text, std::chrono::milliseconds limit);
  void Signal(int signal) const;
  // Exit code, or -signal when a signal ended it, or kTimeout.
  static constexpr int kTimeout = -1000;
  int Wait(std::chrono::milliseconds limit);

  std::string output() const;
  std::string error() const;
  pid_t pid() const { return pid_; }

 private:
  void Collect();

  pid_t pid_ = 0;
  int out_fd_ = -1, error_fd_ = -1, wake_fd_[2] = {-1, -1};
  bool reaped_ = false;
  int status_ = 0;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::string out_, error_;
  bool closed_ = false;
  std::thread reader_;
};

struct Finished {
  int exit_code = 0;
  std::string output, error;
};

// Runs a program to its end.
Finished Run(const std::vector<std::string>& arguments,
             std::chrono::milliseconds limit = std::chrono::seconds(30));

}  // namespace sinew::launch

// A datagram socket that stands in for systemd: it keeps what a process under test reports, word by
// word.
//
// Sets NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID of this process (and so of its children) and
// takes them away at the end. One thread.
#pragma once

#include <poll.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace sinew::testing {

class NotifySocket {
 public:
  // watchdog 0: the unit has none. own_process_only: WATCHDOG_PID is set to this process.
  explicit NotifySocket(std::chrono::microseconds watchdog, bool own_process_only = false) {
    const std::string path = (folder_.path() / "notify").string();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    if (path.size() >= sizeof address.sun_path) throw std::runtime_error(path + ": too long");
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    fd_ = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (::bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error(path + ": cannot be bound");
    }
    ::setenv("NOTIFY_SOCKET", path.c_str(), 1);
    if (watchdog.count() > 0) {
      ::setenv("WATCHDOG_USEC", std::to_string(watchdog.count()).c_str(), 1);
    }
    if (own_process_only) ::setenv("WATCHDOG_PID", std::to_string(::getpid()).c_str(), 1);
  }
  ~NotifySocket() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) ::unsetenv(name);
    ::close(fd_);
  }
  NotifySocket(const NotifySocket&) = delete;
  NotifySocket& operator=(const NotifySocket&) = delete;

  // Everything reported so far and within the time, a word (READY=1) an entry.
  std::vector<std::string> Collect(std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    while (Receive(end)) {
    }
    return std::exchange(words_, {});
  }

  // Waits until a word begins with `text`; false when the time is over. What came before that word
  // is dropped, what came after it is kept.
  bool WaitFor(const std::string& text, std::chrono::milliseconds time) {
    const auto end = std::chrono::steady_clock::now() + time;
    do {
      while (!words_.empty()) {
        const bool found = words_.front().rfind(text, 0) == 0;
        words_.erase(words_.begin());
        if (found) return true;
      }
    } while (Receive(end));
    return false;
  }

 private:
  bool Receive(std::chrono::steady_clock::time_point end) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
        end - std::chrono::steady_clock::now());
    pollfd poll{fd_, POLLIN, 0};
    if (::poll(&poll, 1, static_cast<int>(std::max<long>(left.count(), 0))) != 1) return false;
    char buffer[2048];
    const ssize_t size = ::recv(fd_, buffer, sizeof buffer, 0);
    std::istringstream lines(
        std::string(buffer, static_cast<std::size_t>(std::max<ssize_t>(size, 0))));
    for (std::string line; std::getline(lines, line);) words_.push_back(line);
    return true;
  }

  TemporaryFolder folder_;
  int fd_ = -1;
  std::vector<std::string> words_;
};

}  // namespace sinew::testing

// Reports this process to systemd (sd_notify): ready, alive, its state in words, stopping.
//
// Without NOTIFY_SOCKET in the environment it does nothing. The loop only counts; a thread of this
// class sends, so that a busy systemd never delays the loop. It sends WATCHDOG=1 every quarter of
// the unit's WatchdogSec, and only if the loop has counted on since: a loop that hangs sends
// nothing although its process lives. The thread is of SCHED_OTHER.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace sinew::node {

class SystemdLink {
 public:
  SystemdLink();   // reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID
  ~SystemdLink();  // STOPPING=1; returns when everything is sent
  SystemdLink(const SystemdLink&) = delete;
  SystemdLink& operator=(const SystemdLink&) = delete;

  // The loop goes round. Any thread; no system call.
  void Beat() noexcept { beats_.fetch_add(1, std::memory_order_relaxed); }
  // STATUS=; the first call also says READY=1. Nothing is sent when the text is the last one.
  void SetStatus(const std::string& text);
  void SetStopping();

 private:
  void Run();

  const bool active_;                   // there is a socket to talk to
  std::chrono::microseconds period_{};  // between WATCHDOG=1; 0: the unit has no watchdog
  std::atomic<std::uint64_t> beats_{0};

  std::mutex mutex_;
  std::condition_variable changed_;
  std::string status_;   // newest text
  std::string pending_;  // lines to send at once
  bool ready_ = false, stopping_ = false, ended_ = false;
  std::thread thread_;
};

}  // namespace sinew::node

#include "components/topics/node/systemd_link.h"

#include <systemd/sd-daemon.h>

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "components/topics/node/helper_thread.h"

namespace sinew::node {

SystemdLink::SystemdLink() : active_(std::getenv("NOTIFY_SOCKET") != nullptr) {
  if (!active_) return;
  std::uint64_t limit_us = 0;
  if (::sd_watchdog_enabled(0, &limit_us) > 0) {
    period_ = std::chrono::microseconds(std::max<std::uint64_t>(limit_us / 4, 1));
  }
  thread_ = std::thread([this] { Run(); });
}

SystemdLink::~SystemdLink() {
  if (!active_) return;
  SetStopping();
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ended_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void SystemdLink::SetStatus(const std::string& text) {
  if (!active_) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (ready_ && text == status_) return;
    status_ = text;
    std::string line = text;
    std::replace(line.begin(), line.end(), '\n', ' ');  // a new line would begin another word
    pending_ += "STATUS=" + line + '\n';
    if (!ready_) pending_ += "READY=1\n";
    ready_ = true;
  }
  changed_.notify_one();
}

void SystemdLink::SetStopping() {
  if (!active_) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (stopping_) return;
    stopping_ = true;
    pending_ += "STOPPING=1\n";
  }
  changed_.notify_one();
}

void SystemdLink::Run() {
  using std::chrono::steady_clock;
  internal::BecomeHelper("sinew-systemd");
  auto next = steady_clock::now() + period_;
  std::uint64_t reported = 0;
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    const auto news = [this] { return ended_ || !pending_.empty(); };
    if (period_.count() == 0) {
      changed_.wait(lock, news);
    } else {
      changed_.wait_until(lock, next, news);
    }
    std::string message = std::exchange(pending_, {});
    if (period_.count() != 0 && steady_clock::now() >= next) {
      next = steady_clock::now() + period_;
      if (const std::uint64_t beats = beats_.load(std::memory_order_relaxed); beats != reported) {
        reported = beats;
        message += "WATCHDOG=1\n";
      }
    }
    if (!message.empty()) {
      lock.unlock();
      (void)::sd_notify(0, message.c_str());  // systemd notices what it misses
      lock.lock();
    } else if (ended_) {
      return;
    }
  }
}

}  // namespace sinew::node

#include "tests/support/program.h"

#include <poll.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <fstream>
#include <string>

namespace sinew::testing {
namespace {

using Clock = std::chrono::steady_clock;

int MillisecondsUntil(Clock::time_point end) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
  return static_cast<int>(std::max<std::int64_t>(0, left.count()));
}

}  // namespace

bool IsRunning(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(stat, text)) return false;
  const std::size_t name_end = text.rfind(')');
  return name_end != std::string::npos && name_end + 2 < text.size() && text[name_end + 2] != 'Z' &&
         text[name_end + 2] != 'X';
}

bool WaitUntilGone(pid_t pid, std::chrono::milliseconds limit) {
  const Clock::time_point end = Clock::now() + limit;
  const int handle = static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
  if (handle < 0) return !IsRunning(pid);
  pollfd fd = {handle, POLLIN, 0};
  while (::poll(&fd, 1, MillisecondsUntil(end)) < 0 && errno == EINTR) {
  }
  ::close(handle);
  return !IsRunning(pid);
}

}  // namespace sinew::testing

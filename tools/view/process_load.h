// Share of a core that a process of this host uses, from the texts of /proc/PID/stat (proc(5)).
//
// Pure but for ReadProcessTicks. Not synchronized.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>

namespace sinew::live {

// utime + stime, in clock ticks; nothing: not such a text. The name of a program may hold anything,
// closing parentheses and blanks included.
std::optional<std::uint64_t> ProcessTicks(std::string_view stat);

// Nothing: there is no such process.
std::optional<std::uint64_t> ReadProcessTicks(pid_t pid);

class ProcessLoad {
 public:
  // ticks_per_s: of the kernel, sysconf(_SC_CLK_TCK).
  explicit ProcessLoad(double ticks_per_s) : ticks_per_s_(ticks_per_s) {}

  // Percent of one core since the last call for this process; nothing at the first one, and when
  // the process has gone or its number belongs to another one since.
  std::optional<double> Percent(pid_t pid, std::optional<std::uint64_t> ticks, std::int64_t now_ns);

 private:
  struct Last {
    std::uint64_t ticks;
    std::int64_t now_ns;
  };
  const double ticks_per_s_;
  std::map<pid_t, Last> last_;
};

}  // namespace sinew::live

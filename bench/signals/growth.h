// What processes and the machine hold: open files and memory of each process from its first seconds
// to its last, and what stands in /dev/shm.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "bench/signals/deployment.h"

namespace sinew::signals {

struct Grown {
  double lived_s = 0.0;  // of the process that grew most
  std::int64_t memory_kB = 0, files = 0;
};

struct SharedMemory {
  std::size_t files = 0;
  std::uintmax_t bytes = 0;
};
SharedMemory InSharedMemory();

class Growth {
 public:
  // Once a second or so.
  void Sample(const std::vector<Target>& targets);
  // The largest growth by name, from the fifth second of a process to the last sample of it.
  const std::map<std::string, Grown>& largest() const { return largest_; }

 private:
  struct Held {
    std::chrono::steady_clock::time_point since;
    bool counted = false;  // the first figures are taken
    std::int64_t memory_kB = 0, files = 0;
  };
  std::map<pid_t, Held> processes_;
  std::map<std::string, Grown> largest_;
};

}  // namespace sinew::signals

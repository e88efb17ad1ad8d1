#include "bench/signals/growth.h"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <system_error>

namespace sinew::signals {
namespace {

constexpr std::chrono::seconds kStartUp{5};

std::int64_t Memory_kB(pid_t pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/statm");
  std::int64_t size = 0, resident = 0;
  file >> size >> resident;
  return resident * ::sysconf(_SC_PAGESIZE) / 1024;
}

std::int64_t OpenFiles(pid_t pid) {
  std::error_code error;
  std::int64_t count = 0;
  const std::filesystem::directory_iterator end;
  std::filesystem::directory_iterator entry("/proc/" + std::to_string(pid) + "/fd", error);
  for (; !error && entry != end; entry.increment(error)) ++count;
  return count;
}

}  // namespace

SharedMemory InSharedMemory() {
  SharedMemory held;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", error)) {
    ++held.files;
    const std::uintmax_t bytes = entry.file_size(error);
    if (!error) held.bytes += bytes;
  }
  return held;
}

void Growth::Sample(const std::vector<Target>& targets) {
  const auto now = std::chrono::steady_clock::now();
  std::map<pid_t, Held> still;
  for (const Target& target : targets) {
    const auto known = processes_.find(target.pid);
    Held held = known == processes_.end() ? Held{.since = now} : known->second;
    const auto lived = now - held.since;
    const std::int64_t memory_kB = Memory_kB(target.pid), files = OpenFiles(target.pid);
    if (files > 0 && lived >= kStartUp) {
      if (!held.counted) {
        held.counted = true;
        held.memory_kB = memory_kB;
        held.files = files;
      }
      Grown& largest = largest_[target.name];
      if (memory_kB - held.memory_kB > largest.memory_kB) {
        largest.memory_kB = memory_kB - held.memory_kB;
        largest.lived_s = std::chrono::duration<double>(lived).count();
      }
      largest.files = std::max(largest.files, files - held.files);
    }
    still[target.pid] = held;
  }
  processes_ = std::move(still);
}

}  // namespace sinew::signals

// Resources of a host for real-time participants: limits, CPU governor, disk space. Files are read
// below a root that the caller names.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/inspect/findings.h"

namespace sinew::inspect {

// SCHED_FIFO up to `priority` and locked memory without limit, by ROOT/proc/self/limits, or by the
// capabilities CAP_SYS_NICE and CAP_IPC_LOCK in ROOT/proc/self/status.
std::vector<Finding> CheckRealtimeLimits(const std::filesystem::path& root, int priority);

// ROOT/sys/devices/system/cpu/cpu*/cpufreq/scaling_governor: "performance" on each.
Finding CheckCpuGovernor(const std::filesystem::path& root);

struct DiskSpace {
  std::string path;
  std::uint64_t free_bytes = 0, total_bytes = 0;
};
// As the system reports it. Throws UsageError when the path is not there.
DiskSpace ReadDiskSpace(const std::filesystem::path& path);
// In minutes of a recording at this rate: under 10 a fault, under 120 a warning.
Finding CheckDiskSpace(const DiskSpace& space, double recording_bytes_s);
// Space of /dev/shm: a segment of each participant, in lockstep.
Finding CheckSharedMemorySpace(const DiskSpace& space);

}  // namespace sinew::inspect

// Files of Fast DDS in shared memory: which of them a process uses, and the removal of the others.
//
// A participant that was killed leaves its files in /dev/shm: fastrtps_* (segments and ports of the
// transport, with lock files _el and _sl), fast_datasharing_*, sem.fastrtps_* (semaphores). A file
// is in use when a process maps it or has it open (/proc/PID/maps, /proc/PID/fd). Processes of
// another PID namespace that share /dev/shm are not seen there; removal therefore also asks for the
// lock of every file, which is common to all namespaces.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "tools/inspect/findings.h"

namespace sinew::inspect {

struct SharedFile {
  std::string name;
  std::uint64_t bytes = 0;
  bool in_use = false;
};

struct SharedMemory {
  std::vector<SharedFile> files;    // sorted by name
  std::vector<pid_t> participants;  // processes that have Fast DDS loaded or use such a file
  std::vector<pid_t> unreadable;    // processes that this user may not look into
  bool has_folder = true;           // ROOT/dev/shm is there
};

// Reads ROOT/dev/shm and ROOT/proc. `self`: a process that does not count.
SharedMemory ReadSharedMemory(const std::filesystem::path& root, pid_t self);

Finding CheckSharedMemory(const SharedMemory& memory);

// Removes every file of Fast DDS below ROOT/dev/shm when no participant lives: no process uses one
// or has Fast DDS loaded, none could not be looked into, and nobody holds the lock of any. Else
// removes nothing and says why, as a fault.
Finding CleanSharedMemory(const std::filesystem::path& root, pid_t self);

}  // namespace sinew::inspect

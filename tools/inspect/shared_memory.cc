#include "tools/inspect/shared_memory.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <optional>
#include <set>

#include "components/base/types/text.h"

namespace sinew::inspect {

namespace {

namespace fs = std::filesystem;

constexpr char kSharedFolder[] = "dev/shm";
constexpr char kSharedCheck[] = "shared_memory";

bool IsOfFastDds(const std::string& name) {
  return name.starts_with("fastrtps_") || name.starts_with("fast_datasharing_") ||
         name.starts_with("sem.fastrtps_");
}

std::optional<pid_t> ProcessId(const std::string& name) {
  pid_t id = 0;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), id);
  if (error != std::errc() || end != name.data() + name.size()) return std::nullopt;
  return id;
}

// The file of Fast DDS that a path in /dev/shm names; empty: none.
std::string SharedName(const std::string& path) {
  const std::string folder = std::string("/") + kSharedFolder + "/";
  const std::size_t at = path.find(folder);
  if (at == std::string::npos) return "";
  std::string name = path.substr(at + folder.size());
  name = name.substr(0, name.find(" (deleted)"));
  return IsOfFastDds(name) ? name : "";
}

struct ProcessUse {
  std::set<std::string> files;
  bool has_fast_dds = false;
  bool readable = true;
};

ProcessUse UseOf(const fs::path& process) {
  ProcessUse use;
  std::ifstream maps(process / "maps");
  use.readable = maps.good();
  for (std::string line; std::getline(maps, line);) {
    if (line.find("/libfastrtps.so") != std::string::npos) use.has_fast_dds = true;
    if (const std::string name = SharedName(line); !name.empty()) use.files.insert(name);
  }
  if (maps.bad()) use.readable = false;
  std::error_code error;
  for (fs::directory_iterator entry(process / "fd", error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code gone;
    const std::string target = fs::read_symlink(entry->path(), gone).string();
    if (const std::string name = SharedName(target); !name.empty()) use.files.insert(name);
  }
  return use;
}

std::string Megabytes(std::uint64_t bytes) {
  return types::Text("%.1f MB", static_cast<double>(bytes) * 1e-6);
}

// Somebody else holds a lock of the file (flock), in whatever namespace.
bool IsLocked(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return false;
  const bool locked = ::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return locked;
}

}  // namespace

SharedMemory ReadSharedMemory(const fs::path& root, pid_t self) {
  SharedMemory memory;
  std::error_code error;
  std::set<std::string> used;
  for (fs::directory_iterator entry(root / "proc", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::optional<pid_t> id = ProcessId(entry->path().filename().string());
    if (!id || *id == self) continue;
    std::error_code gone;
    const ProcessUse use = UseOf(entry->path());
    if (!use.readable) {
      if (fs::exists(entry->path(), gone)) memory.unreadable.push_back(*id);
      continue;
    }
    if (use.has_fast_dds || !use.files.empty()) memory.participants.push_back(*id);
    used.insert(use.files.begin(), use.files.end());
  }
  memory.has_folder = fs::is_directory(root / kSharedFolder, error);
  for (fs::directory_iterator entry(root / kSharedFolder, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!IsOfFastDds(name)) continue;
    std::error_code gone;
    const std::uintmax_t bytes = fs::file_size(entry->path(), gone);
    memory.files.push_back(
        {name, gone ? 0 : static_cast<std::uint64_t>(bytes), used.contains(name)});
  }
  std::sort(memory.files.begin(), memory.files.end(),
            [](const SharedFile& a, const SharedFile& b) { return a.name < b.name; });
  std::sort(memory.participants.begin(), memory.participants.end());
  return memory;
}

Finding CheckSharedMemory(const SharedMemory& memory) {
  if (!memory.has_folder) {
    return {kSharedCheck, Severity::kFault, "/dev/shm is missing",
            "mount it (tmpfs): lockstep travels over shared memory"};
  }
  std::uint64_t stale = 0, bytes = 0;
  for (const SharedFile& file : memory.files) {
    if (file.in_use) continue;
    ++stale;
    bytes += file.bytes;
  }
  const std::string of =
      std::to_string(memory.files.size()) + " files of Fast DDS, " +
      std::to_string(memory.participants.size()) +
      (memory.participants.size() == 1 ? " process uses it" : " processes use it");
  if (stale == 0) return {kSharedCheck, Severity::kOk, of + ", none left behind", ""};
  const std::string left =
      std::to_string(stale) + " of " + of + ": used by no process, " + Megabytes(bytes);
  if (!memory.unreadable.empty()) {
    return {kSharedCheck, Severity::kNote,
            left + "; " + std::to_string(memory.unreadable.size()) +
                " processes of other users could not be looked into",
            "run sinew doctor as root to be sure"};
  }
  return {kSharedCheck, Severity::kWarning, left,
          memory.participants.empty() ? "sinew doctor --clean removes them"
                                      : "end all participants, then sinew doctor --clean"};
}

Finding CleanSharedMemory(const fs::path& root, pid_t self) {
  const auto refuse = [](const std::string& why, const std::string& advice) {
    return Finding{kSharedCheck, Severity::kFault, "nothing was removed: " + why, advice};
  };
  const SharedMemory memory = ReadSharedMemory(root, self);
  if (!memory.participants.empty()) {
    return refuse("process " + std::to_string(memory.participants.front()) + " and " +
                      std::to_string(memory.participants.size() - 1) + " others use Fast DDS",
                  "end all participants, then try again");
  }
  if (!memory.unreadable.empty()) {
    return refuse(std::to_string(memory.unreadable.size()) +
                      " processes of other users could not be looked into",
                  "run it as root");
  }
  for (const SharedFile& file : memory.files) {
    if (IsLocked(root / kSharedFolder / file.name)) {
      return refuse(file.name + " is locked by a process that is not seen here",
                    "end the participants in containers that share /dev/shm, then try again");
    }
  }
  std::uint64_t removed = 0, bytes = 0;
  for (const SharedFile& file : memory.files) {
    std::error_code error;
    if (!fs::remove(root / kSharedFolder / file.name, error)) {
      return refuse(
          file.name + ": " + error.message() + " (" + std::to_string(removed) + " before it were)",
          "run it as root");
    }
    ++removed;
    bytes += file.bytes;
  }
  return {kSharedCheck, Severity::kOk,
          std::to_string(removed) + " files of Fast DDS removed, " + Megabytes(bytes), ""};
}

}  // namespace sinew::inspect

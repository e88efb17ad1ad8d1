#include "tools/inspect/host_checks.h"

#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/base/types/text.h"

namespace sinew::inspect {

namespace {

namespace fs = std::filesystem;

// Bits of CapEff, linux/capability.h.
constexpr int kCapIpcLock = 14;
constexpr int kCapSysNice = 23;

// A session on a robot takes minutes, a day of experiments hours.
constexpr double kFaultMinutes = 10.0;
constexpr double kWarningMinutes = 120.0;

// A participant's segment of the shared memory transport (512 kB by default in Fast DDS 2.9, and
// its tables), and a robot's dozen of them with ports.
constexpr double kSegmentBytes = 0.6e6;
constexpr double kParticipants = 16.0;

struct Limit {
  std::optional<double> soft;  // none: unlimited
};

// "Max realtime priority     0      0     " -> soft limits by name.
std::optional<Limit> LimitNamed(const std::string& text, const std::string& name) {
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(name)) continue;
    std::istringstream words(line.substr(name.size()));
    std::string soft;
    words >> soft;
    if (soft == "unlimited") return Limit{};
    double value = 0.0;
    std::istringstream number(soft);
    if (number >> value) return Limit{value};
  }
  return std::nullopt;
}

std::string ReadAll(const fs::path& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

bool HasCapability(const std::string& status, int bit) {
  const std::string key = "CapEff:";
  const std::size_t at = status.find(key);
  if (at == std::string::npos) return false;
  std::istringstream in(status.substr(at + key.size()));
  std::uint64_t capabilities = 0;
  in >> std::hex >> capabilities;
  return (capabilities >> bit & 1u) != 0;
}

}  // namespace

std::vector<Finding> CheckRealtimeLimits(const fs::path& root, int priority) {
  const std::string limits = ReadAll(root / "proc/self/limits");
  const std::string status = ReadAll(root / "proc/self/status");
  std::vector<Finding> findings;
  const auto priorities = LimitNamed(limits, "Max realtime priority");
  const auto memory = LimitNamed(limits, "Max locked memory");
  if (!priorities || !memory) {
    return {{"realtime_limits", Severity::kNote, "/proc/self/limits could not be read", ""}};
  }
  const std::string advice =
      "in /etc/security/limits.d/sinew.conf, then log in again; the units of tools/systemd set it";
  if (HasCapability(status, kCapSysNice)) {
    findings.push_back({"rtprio", Severity::kOk, "SCHED_FIFO by CAP_SYS_NICE", ""});
  } else if (!priorities->soft || *priorities->soft >= priority) {
    findings.push_back({"rtprio", Severity::kOk,
                        "SCHED_FIFO up to priority " +
                            (priorities->soft ? types::Text("%.0f", *priorities->soft) : "99"),
                        ""});
  } else {
    findings.push_back({"rtprio", Severity::kWarning,
                        "SCHED_FIFO up to priority " + types::Text("%.0f", *priorities->soft) +
                            ", --realtime needs " + std::to_string(priority),
                        "`USER - rtprio " + std::to_string(priority) + "` " + advice});
  }
  if (HasCapability(status, kCapIpcLock)) {
    findings.push_back({"memlock", Severity::kOk, "locked memory by CAP_IPC_LOCK", ""});
  } else if (!memory->soft) {
    findings.push_back({"memlock", Severity::kOk, "locked memory without limit", ""});
  } else {
    findings.push_back({"memlock", Severity::kWarning,
                        "locked memory up to " + types::Text("%.1f MB", *memory->soft * 1e-6) +
                            ", --realtime locks all of a process",
                        "`USER - memlock unlimited` " + advice});
  }
  return findings;
}

Finding CheckCpuGovernor(const fs::path& root) {
  const fs::path folder = root / "sys/devices/system/cpu";
  std::map<std::string, int> governors;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (!entry->path().filename().string().starts_with("cpu")) continue;
    std::istringstream in(ReadAll(entry->path() / "cpufreq/scaling_governor"));
    std::string governor;
    if (in >> governor) ++governors[governor];
  }
  if (governors.empty()) {
    return {"cpu_governor", Severity::kNote,
            "no CPU has a frequency governor (a virtual machine, or firmware sets it)", ""};
  }
  const std::string list = types::Joined(governors, ", ", [](const auto& each) {
    return each.first + " on " + std::to_string(each.second);
  });
  if (governors.size() == 1 && governors.contains("performance")) {
    return {"cpu_governor", Severity::kOk, list + " CPUs", ""};
  }
  return {"cpu_governor", Severity::kWarning, list + " CPUs",
          "cpupower frequency-set -g performance: a core that was idle wakes late otherwise"};
}

DiskSpace ReadDiskSpace(const fs::path& path) {
  std::error_code error;
  const fs::space_info info = fs::space(path, error);
  if (error) throw UsageError(path.string() + ": " + error.message());
  return {path.string(), info.available, info.capacity};
}

Finding CheckDiskSpace(const DiskSpace& space, double recording_bytes_s) {
  const double minutes = static_cast<double>(space.free_bytes) / recording_bytes_s / 60.0;
  const std::string text = space.path + ": " +
                           types::Text("%.1f GB free, %.0f minutes of recording",
                                       static_cast<double>(space.free_bytes) * 1e-9, minutes);
  const Severity severity = minutes < kFaultMinutes     ? Severity::kFault
                            : minutes < kWarningMinutes ? Severity::kWarning
                                                        : Severity::kOk;
  return {"disk_space", severity, text,
          severity == Severity::kOk ? "" : "remove old recordings, or record to another disk"};
}

Finding CheckSharedMemorySpace(const DiskSpace& space) {
  const double needed = kSegmentBytes * kParticipants;
  const std::string text =
      space.path + ": " + types::Text("%.1f MB free", static_cast<double>(space.free_bytes) * 1e-6);
  if (static_cast<double>(space.free_bytes) >= needed) {
    return {"shared_memory_space", Severity::kOk, text, ""};
  }
  return {"shared_memory_space", Severity::kFault,
          text + types::Text(", a robot in lockstep needs %.1f MB", needed * 1e-6),
          "remove what is left behind (sinew doctor --clean), or mount a larger /dev/shm"};
}

}  // namespace sinew::inspect

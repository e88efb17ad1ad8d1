#include "components/robot/estop/estop_config.h"

#include <unistd.h>

#include <cstdlib>

namespace sinew::estop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRuntimeFolder = "/run/sinew";
constexpr const char* kStateFolder = "/var/lib/sinew";

// The value of a variable that holds an absolute path; empty: there is none.
fs::path FolderOf(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && value[0] == '/' ? fs::path(value) : fs::path();
}

fs::path PathOf(const config::Section& section, const std::string& text) {
  const fs::path path(text);
  return path.is_absolute() ? path : section.file().parent_path() / path;
}

mode_t ReadMode(const config::Section& section) {
  if (!section.Has("socket_mode")) return kSocketMode;
  const std::string digits = section.Text("socket_mode");
  std::size_t used = 0;
  unsigned long mode = 01000;
  try {
    mode = std::stoul(digits, &used, 8);
  } catch (const std::exception&) {
  }
  if (used != digits.size() || mode > 0777 || (mode & 0200) == 0) {
    section.Fail("socket_mode", "is '" + digits +
                                    "', expected octal digits that let the owner write, such as "
                                    "0660");
  }
  return static_cast<mode_t>(mode);
}

}  // namespace

std::vector<fs::path> SocketCandidates(int domain_id) {
  const std::string domain = std::to_string(domain_id) + ".sock";
  std::vector<fs::path> candidates{fs::path(kRuntimeFolder) / ("estop-" + domain)};
  const fs::path runtime = FolderOf("XDG_RUNTIME_DIR");
  if (!runtime.empty()) candidates.push_back(runtime / ("sinew-estop-" + domain));
  candidates.push_back("/tmp/sinew-estop-" + std::to_string(::getuid()) + "-" + domain);
  return candidates;
}

fs::path DefaultSocket(int domain_id) {
  const std::vector<fs::path> candidates = SocketCandidates(domain_id);
  for (const fs::path& path : candidates) {
    if (::access(path.parent_path().c_str(), W_OK) == 0) return path;
  }
  return candidates.back();
}

fs::path StateFolder() {
  std::error_code ignored;
  if (fs::exists(kStateFolder, ignored)) return kStateFolder;
  fs::path state = FolderOf("XDG_STATE_HOME");
  if (const fs::path home = FolderOf("HOME"); state.empty() && !home.empty()) {
    state = home / ".local" / "state";
  }
  if (state.empty()) {
    throw UsageError(std::string("no folder for what outlives the bridge: ") + kStateFolder +
                     ", XDG_STATE_HOME or HOME is expected");
  }
  fs::create_directories(state / "sinew", ignored);  // what is missing is reported at its use
  return state / "sinew";
}

fs::path DefaultLatch(int domain_id) {
  return StateFolder() / ("estop-" + std::to_string(domain_id) + ".latch");
}

Config LoadConfig(const config::Section& section, int domain_id, bool live) {
  const char* left_out = live ? "default" : "none";
  Config config;
  const std::string socket = section.TextOr("socket", left_out);
  if (socket == "default") {
    config.socket = DefaultSocket(domain_id);
  } else if (socket != "none") {
    config.socket = PathOf(section, socket);
  }
  config.socket_mode = ReadMode(section);
  const std::string latch = section.TextOr("latch", left_out);
  if (latch == "default") {
    config.latch = DefaultLatch(domain_id);
  } else if (latch != "none") {
    config.latch = PathOf(section, latch);
  } else if (live) {
    section.Fail("latch", "is none, expected a path: the estop of hardware outlives its bridge");
  }
  for (const std::string& name : section.TextsOr("required", {})) {
    if (name.empty() || name.size() > 64) {
      section.Fail("required", "holds '" + name + "', expected a participant's name");
    }
    config.required.push_back(name);
  }
  section.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::estop

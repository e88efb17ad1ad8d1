#include "components/robot/estop/estop_config.h"

#include <sys/stat.h>

#include "components/base/config/unix_socket.h"
#include "components/robot/estop/socket_folder.h"

namespace sinew::estop {
namespace {

namespace fs = std::filesystem;

constexpr const char* kStateFolder = "/var/lib/sinew";

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

fs::path StateFolder() {
  (void)::mkdir(kStateFolder, 0755);  // by root; the units make it for their user
  std::error_code ignored;
  if (fs::is_directory(kStateFolder, ignored)) return kStateFolder;
  throw UsageError(std::string(kStateFolder) +
                   ", the folder for what outlives the bridge, is not there; expected 'sudo "
                   "install -d -o $USER " +
                   kStateFolder + "', or paths in the configuration (estop: {latch: PATH})");
}

fs::path DefaultLatch(const std::string& name) {
  return StateFolder() / ("estop-" + config::FileNamePart(name) + ".latch");
}

Config LoadConfig(const config::Section& section, const std::string& name, int domain_id,
                  bool live) {
  const char* left_out = live ? "default" : "none";
  Config config;
  const std::string socket = section.TextOr("socket", left_out);
  if (socket == "default") {
    config.socket = DefaultSocket(name, domain_id);
  } else if (socket != "none") {
    config.socket = PathOf(section, socket);
  }
  config.socket_mode = ReadMode(section);
  const std::string latch = section.TextOr("latch", left_out);
  if (latch == "default") {
    config.latch = DefaultLatch(name);
  } else if (latch != "none") {
    config.latch = PathOf(section, latch);
  } else if (live) {
    section.Fail("latch", "is none, expected a path: the estop of hardware outlives its bridge");
  }
  for (const std::string& estop : section.TextsOr("required", {})) {
    if (estop.empty() || estop.size() > 64) {
      section.Fail("required", "holds '" + estop + "', expected a participant's name");
    }
    config.required.push_back(estop);
  }
  section.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::estop

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

mode_t ModeOf(const config::Fields& f, const std::string& digits) {
  std::size_t used = 0;
  unsigned long mode = 01000;
  try {
    mode = std::stoul(digits, &used, 8);
  } catch (const std::exception&) {
  }
  if (used != digits.size() || mode > 0777 || (mode & 0200) == 0) {
    f.Fail("socket_mode",
           "is '" + digits + "', expected octal digits that let the owner write, such as 0660");
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

void Describe(config::Fields& f, Block& c) {
  f("socket", c.socket, "default, none or a path; left out: default for hardware, none else");
  f("socket_mode", c.socket_mode, "octal digits");
  f("latch", c.latch, "the same, of what outlives the process; hardware has one");
  f("required", c.required, "sinew-estop participants whose heartbeat is awaited");
}

Config LoadConfig(const config::Section& section, const std::string& name, int domain_id,
                  bool live) {
  Block block;
  config::Fields f(section);
  Describe(f, block);
  const std::string left_out = live ? "default" : "none";
  const std::string socket = block.socket.value_or(left_out),
                    latch = block.latch.value_or(left_out);
  Config config;
  if (socket == "default") {
    config.socket = DefaultSocket(name, domain_id);
  } else if (socket != "none") {
    config.socket = PathOf(section, socket);
  }
  config.socket_mode = ModeOf(f, block.socket_mode);
  if (latch == "default") {
    config.latch = DefaultLatch(name);
  } else if (latch != "none") {
    config.latch = PathOf(section, latch);
  } else if (live) {
    f.Fail("latch", "is none, expected a path: the estop of hardware outlives its bridge");
  }
  for (const std::string& estop : block.required) {
    if (estop.empty() || estop.size() > 64) {
      f.Fail("required", "holds '" + estop + "', expected a participant's name");
    }
  }
  config.required = block.required;
  section.RejectUnknownKeys();
  return config;
}

}  // namespace sinew::estop

// Where a host takes an estop without DDS, and where it is kept: paths of the socket and of the
// latch, their defaults, and the `estop:` block of a state provider's configuration.
//
// Not for loops: reads the environment and allocates.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/config.h"

namespace sinew::estop {

// The socket can be pressed by its owner and its group, and by nobody else.
inline constexpr mode_t kSocketMode = 0660;

struct Config {
  std::optional<std::filesystem::path> socket;  // none: an estop comes by DDS only
  mode_t socket_mode = kSocketMode;
  std::optional<std::filesystem::path> latch;  // none: an estop ends with the process
  std::vector<std::string> required;           // participants whose heartbeat is awaited (watch.h)
};

// Where the state provider of a domain may have its socket on this host, the preferred first:
// /run/sinew, XDG_RUNTIME_DIR, /tmp (there with the user's number in the name).
std::vector<std::filesystem::path> SocketCandidates(int domain_id);
// The first candidate whose folder this process may write to.
std::filesystem::path DefaultSocket(int domain_id);
// Where a bridge keeps what outlives it: /var/lib/sinew where that folder exists, whether it can be
// written to or not (who runs the bridge does not decide which latch counts), else XDG_STATE_HOME
// or ~/.local/state. Throws UsageError: there is none of them.
std::filesystem::path StateFolder();
std::filesystem::path DefaultLatch(int domain_id);  // in it

// Keys of an `estop:` block: `socket` and `latch`, each `default`, `none` or a path (relative ones
// are relative to the file), and `socket_mode`, octal digits. Left out: `default` for hardware,
// `none` for a simulation. `required`: names of sinew-estop participants; none by default. Throws
// UsageError: hardware without a latch, and what a Section refuses.
Config LoadConfig(const config::Section& section, int domain_id, bool live);

}  // namespace sinew::estop

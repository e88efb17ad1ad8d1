// Paths of the socket by which a host takes an estop without DDS, and of the latch that keeps it:
// their defaults, and the `estop:` block of a state provider's configuration.
//
// Not for loops: reads the file system and allocates.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/fields.h"

namespace sinew::estop {

// The socket can be pressed by its owner and its group, and by nobody else.
inline constexpr mode_t kSocketMode = 0660;

struct Config {
  std::optional<std::filesystem::path> socket;  // none: an estop comes by DDS only
  mode_t socket_mode = kSocketMode;
  std::optional<std::filesystem::path> latch;  // none: an estop ends with the process
  std::vector<std::string> required;           // participants whose heartbeat is awaited (watch.h)
};

// The folder of what outlives a bridge: /var/lib/sinew, whoever runs the bridge and in whichever
// domain; root makes it where it is absent. Throws UsageError: it is not there.
std::filesystem::path StateFolder();
// In it, by the state provider's name, which no other one of this host has (LatchFile::Lock).
std::filesystem::path DefaultLatch(const std::string& name);

// An `estop:` block as it is written; relative paths are relative to the file.
struct Block {
  std::optional<std::string> socket, latch;  // socket_folder.h has the socket's default
  std::string socket_mode = "0660";          // kSocketMode
  std::vector<std::string> required;
};
void Describe(config::Fields& f, Block& c);

// Throws UsageError: hardware without a latch, and what a Section refuses.
Config LoadConfig(const config::Section& section, const std::string& name, int domain_id,
                  bool live);

}  // namespace sinew::estop

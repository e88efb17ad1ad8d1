// Sends a recording into a domain.
//
// Two ways. On its own: messages go out at the recorded pace (times `rate`), or in lockstep as fast
// as readers take them; with joint_state among them the player is the state provider. Following:
// without joint_state the player stands in for other components of a running session: what was
// recorded at tick k goes out at the k-th tick of that session, with its session and stamp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/logger/player/playlist.h"
#include "components/node/node.h"
#include "components/node/options.h"

namespace CLI {
class App;
}

namespace sinew::logger {

struct PlayOptions {
  std::filesystem::path path;
  PlaylistOptions list;
  std::vector<std::string> remap;  // FROM:TO
  double rate = -1.0;  // times real time; 0: as fast as it goes; below 0: 1, in lockstep 0
  bool follow = false;
  int wait_readers = -1;  // of every topic; below 0: 0, in lockstep some reader of the first topic
  double wait_timeout_s = 30.0;    // for readers, and for a running session when following
  std::vector<std::string> await;  // TOPIC or TOPIC:WINDOW, lockstep
};

// FILE, --topics, --remap, --rate, --start, --end, --follow, --wait-readers, --wait-timeout,
// --await.
void AddPlayOptions(CLI::App& app, PlayOptions* options);

struct PlayResult {
  std::uint64_t messages = 0;
  std::uint64_t message_count = 0;  // of the playlist
  std::uint64_t write_failures = 0;
  double wall_s = 0.0;
  double recorded_s = 0.0;  // of what was played
};

// Throws UsageError (broken file, other types, no readers, a second state provider),
// std::runtime_error when a reliable reader does not take messages. `progress` is called about ten
// times a second, if given.
PlayResult Play(node::Node& node, const node::StopFlag& stop, const PlayOptions& options,
                const std::function<void(const PlayResult&)>& progress = {});

}  // namespace sinew::logger

// Sends a recording into a domain.
//
// Two ways. On its own: messages go out at the recorded pace (times `rate`), or in lockstep as fast
// as readers take them; with joint_state among them the player is the state provider. It can be
// paused, stepped and moved while it runs (play_control.h), by its caller and by the socket of
// control_socket.h. Following:
// without joint_state the player stands in for other components of a running session: what was
// recorded at tick k goes out at the k-th tick of that session, with its session and stamp.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/record/logger/player/play_control.h"
#include "components/record/logger/player/playlist.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"

namespace CLI {
class App;
}

namespace sinew::logger {

struct PlayOptions {
  std::filesystem::path path;
  PlaylistOptions list;
  std::vector<std::string> remap;  // FROM:TO
  double rate = -1.0;      // times real time (pace.h); below 0: 1, in lockstep as fast as it goes
  std::uint64_t loop = 1;  // how often it is played; 0: until it is stopped
  bool paused = false;     // from the start
  bool follow = false;
  // Readers of every topic to wait for. Below 0: some readers of any topic, and no new one for
  // 300 ms; in real time without any it begins after 2 s.
  int wait_readers = -1;
  double wait_timeout_s = 30.0;    // for readers, and for a running session when following
  std::vector<std::string> await;  // TOPIC or TOPIC:WINDOW, lockstep
};

// FILE, --topics, --exclude, --remap, --rate, --loop, --paused, --start, --end, --follow,
// --wait-readers, --wait-timeout, --await.
void AddPlayOptions(CLI::App& app, PlayOptions* options);

struct PlayResult {
  std::uint64_t messages = 0;
  std::uint64_t message_count = 0;  // of the playlist
  std::uint64_t write_failures = 0;
  double wall_s = 0.0;
  double recorded_s = 0.0;  // of what was played, all passes together
  PlayStatus status;
};

// Takes the requests of `control`, its own and those of its socket, and replies with "ok STATUS"
// or "error REASON"; without a socket (another player has this name) it warns. Throws UsageError
// (broken file, other types, no readers, a second state provider), std::runtime_error when a
// reliable reader does not take messages. `progress` is called about ten times a second, if given.
PlayResult Play(node::Node& node, const node::StopFlag& stop, const PlayOptions& options,
                PlayControl& control, const std::function<void(const PlayResult&)>& progress = {});

}  // namespace sinew::logger

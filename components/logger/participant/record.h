// Records topics of a domain into a file until the session ends or somebody stops it.
//
// Lockstep: recording_progress goes out every 16 ticks (and when it is quiet), so that a state
// provider can wait for the recorder; at the session's last tick the file ends once every topic has
// reached it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/node/node.h"
#include "components/node/options.h"

namespace CLI {
class App;
}

namespace sinew::logger {

struct RecordOptions {
  std::filesystem::path out;
  std::vector<std::string> topics;  // empty: all but recording_progress
  std::vector<std::string> notes;   // KEY=VALUE, into the metadata
  bool overwrite = false;
  bool keep_going = false;  // further sessions go into the same file
  double duration_s = 0.0;  // wall clock; 0: no limit
};

// --out, --topics, --note, --overwrite, --keep-going, --duration.
void AddRecordOptions(CLI::App& app, RecordOptions* options);

struct RecordResult {
  std::uint64_t messages = 0;
  std::uint64_t dropped = 0;
  std::uint64_t missing_ticks = 0;  // of joint_state: sent, but never received
  std::uint64_t bytes = 0;
  int topics = 0;   // that had messages
  std::string end;  // why it ended
};

// `progress` is called about ten times a second, if given. Throws UsageError (no such topic, file
// there), std::runtime_error when the file cannot be written any more: what is in it can be read.
RecordResult Record(node::Node& node, const node::StopFlag& stop, const RecordOptions& options,
                    const std::function<void(const RecordResult&)>& progress = {});

}  // namespace sinew::logger

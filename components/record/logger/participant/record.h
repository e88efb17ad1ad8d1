// Records topics of a domain into files until the session ends or somebody stops it.
//
// Lockstep: recording_progress goes out every 16 ticks (and when it is quiet), so that a state
// provider can wait for the recorder; at the session's last tick the file ends once every topic has
// reached it.
//
// Numbered files (split, or of a ring) are read one by one: each begins with what is still valid of
// what came before it (recorded_files.h), and snapshot_request asks the components for their state
// when one begins and twice in the span of a ring.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "components/record/recording/compression.h"
#include "components/topics/node/node.h"
#include "components/topics/node/options.h"

namespace CLI {
class App;
}

namespace sinew::logger {

struct RecordOptions {
  std::filesystem::path out;
  std::vector<std::string> topics;   // names or regular expressions; empty: all but
                                     // recording_progress
  std::vector<std::string> exclude;  // the same; left out
  std::vector<std::string> notes;    // KEY=VALUE, into the metadata
  std::vector<std::string> attach;   // FILE or NAME=FILE, into the recording
  bool overwrite = false;
  bool keep_going = false;  // further sessions go into the same file
  double duration_s = 0.0;  // wall clock; 0: no limit
  recording::Compression compression = recording::Compression::kZstd;
  std::uint64_t split_bytes = 0;  // numbered files of about this size; 0: one file
  double split_s = 0.0;           // numbered files of this length; 0: one file
  std::optional<double> sync_s;   // to the disk so often; 0: at the end. None: 1 in real time, 0
                                  // in lockstep
  double last_s = 0.0;            // > 0: nothing is written but after a trigger, see ring
  double after_s = 10.0;          // what is written after a trigger
  bool on_fault = false;          // a fault is a trigger, as SIGUSR1 is
};

// The options of `sinew-logger` and `sinew record`.
void AddRecordOptions(CLI::App& app, RecordOptions* options);

struct RecordResult {
  std::uint64_t messages = 0;  // in the files
  std::uint64_t dropped = 0;
  std::uint64_t lost = 0;           // reported by DDS
  std::uint64_t missing = 0;        // gaps in the numbers of the writers' samples
  std::uint64_t missing_ticks = 0;  // of joint_state: sent, but never received
  std::uint64_t bytes = 0;
  int topics = 0;  // that had messages
  int files = 0;
  int triggers = 0;  // of a ring
  std::string end;   // why it ended
};

// `progress` is called about ten times a second, if given. Throws UsageError (no such topic, file
// there, options that exclude each other), std::runtime_error when the file cannot be written any
// more: what is in it can be read.
RecordResult Record(node::Node& node, const node::StopFlag& stop, const RecordOptions& options,
                    const std::function<void(const RecordResult&)>& progress = {});

}  // namespace sinew::logger

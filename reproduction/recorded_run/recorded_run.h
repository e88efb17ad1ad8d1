// A deployment run to its end with a recording, for measurements that need the real processes.
//
// The calling thread waits. The recording appears when the run has ended well, whole.
#pragma once

#include <filesystem>
#include <string>

#include "tools/launch/deployment.h"

namespace sinew::reproduction {

struct RecordedRun {
  std::string name;  // in messages
  std::filesystem::path deployment;
  launch::Overrides overrides;      // `record` is set here
  std::filesystem::path recording;  // FILE.mcap; one that is there is replaced
  std::filesystem::path log;        // what the processes write
  std::filesystem::path programs;   // folder of the participants; empty: that of this program
};

// A run that ends because its processes did not find each other before the first tick is started
// once more, with a line on stderr: nothing has moved yet. Throws UsageError for what is wrong in
// files, std::runtime_error naming the process that failed, its cause and last lines.
void RunRecorded(const RecordedRun& run);

}  // namespace sinew::reproduction

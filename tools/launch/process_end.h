// Meaning of the end of a process: failure or not, started again or not, and after how long.
//
// Pure; statuses are those of waitpid.
#pragma once

#include <string>

#include "tools/launch/deployment.h"

namespace sinew::launch {

struct ProcessEnd {
  int status = 0;
  bool deployment_stops = false;  // the session has ended, or processes are being stopped
  bool asked_to_stop = false;     // the stop signals are being sent
  bool is_provider = false;
  int restarts = 0;  // of this process so far
};

// "exit code 3", "signal 11 (Segmentation fault)".
std::string CauseOf(int status);

// A status that is not 0 and not the answer to a stop signal: death by SIGINT or SIGTERM, or the
// shells' exit code for it.
bool Failed(const ProcessEnd& end);

// By the process's policy and its largest number of restarts. A provider that ends without failure
// ends the session, so `always` does not start it again.
bool StartsAgain(const Process& process, const ProcessEnd& end);

// Seconds before restart number `restarts` + 1: doubled each time, at most 60.
double BackOff_s(const Process& process, int restarts);

}  // namespace sinew::launch

// Starts the processes of a deployment, watches and restarts them, stops them in a good order.
//
// One thread. Signals go to process groups that a run made, never to
// anything else; if this process dies, the kernel sends SIGTERM to its children, which end in
// order.
#pragma once

#include <string>
#include <vector>

#include "tools/launch/deployment.h"
#include "tools/launch/output.h"

namespace sinew::launch {

struct Failure {
  std::string process;
  std::string cause;                    // "exit code 3", "signal 11 (Segmentation fault)"
  std::vector<std::string> last_lines;  // of its error stream, else of its output
};

struct Result {
  std::vector<Failure> failures;  // those that were not mended by a restart
  int restarts = 0;
  double duration_s = 0.0;
  bool stopped_by_user = false;
  bool ok() const { return failures.empty(); }
};

// Blocks until every process has ended. `output` names the processes in the order of the
// deployment. SIGINT, SIGTERM, SIGQUIT and SIGHUP stop the deployment; a second one skips to
// SIGTERM, a third to SIGKILL.
Result RunDeployment(const Deployment& deployment, Output& output);

}  // namespace sinew::launch

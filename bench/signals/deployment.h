// The rig behind its virtual bus: `sinew launch` with every participant, a second controller that
// stands by and a logger. Bus and axes are the hardware: they live on, and get no signals.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::signals {

struct Target {
  pid_t pid = 0;
  std::string name;  // in the deployment; "launcher" of the launcher itself
};

class Deployment {
 public:
  // Throws std::runtime_error where a configuration of the rig is not as it was.
  Deployment(int domain, bool realtime);
  ~Deployment();

  const std::string& bus() const { return bus_path_; }
  // Anew, after the one before has ended.
  void Launch();
  bool launched() const { return launch_ != nullptr && testing::IsRunning(launch_->pid()); }
  // Who lives and belongs to the deployment, the launcher first. Bus and axes are not among them.
  std::vector<Target> Targets() const;
  // Bus and axes.
  std::vector<Target> Hardware() const;
  // The launcher has ended: whoever of its processes still lives after the limit.
  std::vector<Target> LeftBehind(std::vector<Target> known, std::chrono::milliseconds limit) const;
  // SIGINT, and the end within a time; false: it did not end.
  bool Stop();
  std::string Log() const;

 private:
  int domain_;
  testing::TemporaryFolder folder_;
  std::string bus_path_, deployment_;
  std::unique_ptr<testing::Program> hardware_bus_, axes_, launch_;
};

}  // namespace sinew::signals

// Runs a trial as `sinew launch` would: a deployment in lockstep, every participant a process, and
// a recording that is scored.
//
// A trial's files stand in folder/NAME/: its configuration, the recording, the processes' words. A
// recording that is there and was made with the same configuration is not made again. Throws
// UsageError for what is wrong in files, std::runtime_error for a run that failed. One thread.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "reproduction/control_test/inverse.h"
#include "reproduction/control_test/trial.h"

namespace sinew::control_test {

struct RunnerConfig {
  std::filesystem::path rig;       // robots/rig
  std::filesystem::path model;     // with identified parameters, for (7.1)
  std::filesystem::path folder;    // of the trials
  std::filesystem::path programs;  // folder of the participants; empty: that of this program
  int domain_id = 0;
  int inverse_rounds = 12;
};

struct Outcome {
  Trial trial;
  TrialScore score;
  double inverse_mse_rad2 = 0.0;  // of the iteration without noise; arm kInverse only
};

class Runner {
 public:
  explicit Runner(RunnerConfig config);

  Outcome Run(const Trial& trial);

 private:
  const Inverse& InverseOf(const Trial& trial);

  RunnerConfig config_;
  std::map<std::string, Inverse> inverses_;  // by pressure, load and cycles
};

}  // namespace sinew::control_test

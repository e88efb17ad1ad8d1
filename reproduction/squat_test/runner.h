// Runs a squat as `sinew launch` would: lockstep, every participant a process, and a recording.
//
// A run's files stand in folder/NAME/. A recording that is there and was made with the same files
// is not made again. Throws UsageError for what is wrong in files, std::runtime_error for a run
// that failed. One thread.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "reproduction/squat_test/arms.h"
#include "reproduction/squat_test/squat_recording.h"
#include "tools/sinew/performance_section.h"

namespace sinew::squat_test {

struct RunnerConfig {
  std::filesystem::path robot;     // robots/biped
  std::filesystem::path folder;    // of the runs
  std::filesystem::path programs;  // folder of the participants; empty: that of this program
  int domain_id = 0;
};

struct Squats {
  const Arm* arm = nullptr;
  Load load = Load::kNone;
  int count = 0;
  std::filesystem::path file;  // the recording
  SquatRecording recording;
  double mse_rad2 = 0.0;           // of all joints, from the first squat to the last one's end
  std::optional<double> fall_s;    // it fell
  tools::MeasuredSession session;  // energies, from arming to the end
};

// Load::kPutOn has six squats, the others two.
Squats RunSquats(const RunnerConfig& config, const Arm& arm, Load load);

}  // namespace sinew::squat_test

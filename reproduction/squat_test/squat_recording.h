// A recorded squat: reference and position of every joint, and how the base was held.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "components/base/types/joints.h"

namespace sinew::squat_test {

struct SquatRecording {
  double period_s = 0.0;
  int joints = 0;
  // A tick each, from the first one on that has a reference.
  std::vector<double> time_s;
  std::vector<types::JointArray<double>> reference_rad, position_rad;
  // Height of the base, m, and its angle from upright, rad, by the simulation's truth.
  std::vector<double> height_m, tilt_rad;
};

// Throws UsageError naming the file and the topic that it lacks: joint_state, reference,
// sim_body_truth.
SquatRecording ReadSquats(const std::filesystem::path& file);

// Mean over joints and ticks of (reference - position)^2 from begin_s on, before end_s; rad^2.
// Throws std::invalid_argument when the recording ends before.
double MeanSquareError(const SquatRecording& recording, double begin_s, double end_s);

// The first time at which the base is tilted by more than 30 degrees or lower than 0.8 of what the
// lowest point of the reference leaves of its height at the start, s. Nothing: it stood.
std::optional<double> FallTime(const SquatRecording& recording, double depth_m);

// Root of the mean square error of all joints over the window_s before each tick (7.7), rad.
std::vector<double> SlidingError(const SquatRecording& recording, double window_s);

}  // namespace sinew::squat_test

// Recordings of squats whose errors are known.
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "reproduction/squat_test/runner.h"

namespace sinew::squat_test {

// Twelve joints at 100 Hz, each behind its reference by error_rad of the time.
inline SquatRecording Tracked(double seconds, const std::function<double(double)>& error_rad) {
  SquatRecording recording;
  recording.period_s = 0.01;
  recording.joints = 12;
  for (int k = 0; k < static_cast<int>(std::lround(seconds / recording.period_s)); ++k) {
    const double time_s = k * recording.period_s;
    types::JointArray<double> reference{}, position{};
    for (std::size_t j = 0; j < 12; ++j) {
      reference[j] = std::sin(time_s + static_cast<double>(j));
      position[j] = reference[j] - error_rad(time_s);
    }
    recording.time_s.push_back(time_s);
    recording.reference_rad.push_back(reference);
    recording.position_rad.push_back(position);
    recording.height_m.push_back(0.75);
    recording.tilt_rad.push_back(0.01);
  }
  return recording;
}

inline const Arm& ArmOf(const std::string& id) {
  for (const Arm& arm : Arms()) {
    if (arm.id == id) return arm;
  }
  throw std::invalid_argument(id);
}

inline Squats SquatsOf(const std::string& arm, Load load,
                       const std::function<double(double)>& error_rad) {
  Squats squats;
  squats.arm = &ArmOf(arm);
  squats.load = load;
  squats.count = load == Load::kPutOn ? kSixSquats : kBenchmarkSquats;
  const double end_s = kStart_s + squats.count * kSquat_s;
  squats.recording = Tracked(end_s + kRest_s, error_rad);
  squats.mse_rad2 = MeanSquareError(squats.recording, kStart_s, end_s);
  return squats;
}

}  // namespace sinew::squat_test

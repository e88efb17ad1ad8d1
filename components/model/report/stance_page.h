// The result of close-loop on a robot that stands on two feet (components/model/stance_fit):
// sentences, pictures and the page. Pure data and text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/model/report/report.h"
#include "components/model/stance_fit/stance_fit.h"

namespace sinew::report {

struct StanceReport {
  std::string robot;
  std::string model_file;
  std::vector<Recording> train;
  std::vector<Recording> held_out;
  stance_fit::StanceFitResult result;
  actuator::RobotModel declared;  // that was analysed
  std::uint64_t seed = 1;
  double seconds = 0.0;  // it took
};

// "payload of base: 3.95 +- 0.25 kg at x 31 +- 9, y 22 +- 9 mm, z not excited", or
// "coulomb of left_ankle_pitch: coulomb_Nm = 1.5 +- 0.11".
std::string StanceEffectText(const stance_fit::StanceEffect& effect);

// The verdict in words: what was found, "no effect", or why the data cannot show it.
std::string VerdictSentence(const StanceReport& report);

// One row of the balance on one kind of recordings.
struct StanceErrorLine {
  std::string key;   // "force_z_N", "moment_x_Nm", a joint's name
  std::string what;  // for people
  std::string unit;
  double declared = 0.0, corrected = 0.0;  // rms
};

// Vertical force, moments, torque of every joint that moves, share of all.
std::vector<StanceErrorLine> StanceErrors(const stance_fit::StanceFitResult& result, bool held_out);

// A declared value that the refit moved by more than kShift tolerances: friction that grew by less
// than what names an effect is there.
struct StanceShift {
  std::string parameter;  // "coulomb.coulomb_Nm of left_hip_pitch"
  double declared = 0.0, corrected = 0.0, tolerances = 0.0;
};
inline constexpr double kShift = 2.0;  // of a normal value one in 22 is further off

// Shifts of declared terms that no effect in the model changed.
std::vector<StanceShift> StanceShifts(const StanceReport& report);

Page MakePage(const StanceReport& report);

}  // namespace sinew::report

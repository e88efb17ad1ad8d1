// The squats of tables 6.6, 6.7 and 7.1 and of Fig 7.10 as trials: which deployment with which
// control, load and reference, and what was published. Pure data.
#pragma once

#include <string>
#include <vector>

namespace sinew::squat_test {

enum class Load {
  kNone,
  kFromStart,  // 4 kg on the torso
  kPutOn,      // the same, at the end of the third of six squats
};

// Published mean square error, rad^2, and energy, J; 0: none.
struct Published {
  double mse = 0.0, mse_loaded = 0.0;
  double energy_J = 0.0, energy_loaded_J = 0.0;
};

struct Arm {
  std::string id;          // "pid-esn": a file name
  std::string title;       // "PID + ESN"
  std::string deployment;  // in robots/biped/squat_test
  std::string control;     // in robots/biped
  std::string esn = {};    // configuration of `esn`; empty: the deployment has none
  std::string esn_program = {};
  Published simulated = {};  // tables 6.6 and 6.7
  Published prototype = {};  // table 7.1
  std::string figure = {};   // of the motion without load
  bool six_squats = false;   // among the three of Fig 7.10
};

const std::vector<Arm>& Arms();

// The squats begin after the delay and the soft start of reference_benchmark.yaml and
// reference_six.yaml, one every 5 s.
inline constexpr double kStart_s = 3.5;
inline constexpr double kSquat_s = 5.0;
inline constexpr int kBenchmarkSquats = 2;
inline constexpr int kSixSquats = 6;
inline constexpr int kPutOnAfter = 3;    // squats; payload.yaml
inline constexpr double kRest_s = 1.5;   // soft stop, and a look at the end
inline constexpr double kDepth_m = 0.4;  // of a squat

}  // namespace sinew::squat_test

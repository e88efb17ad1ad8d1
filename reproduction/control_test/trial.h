// The control test of Figs 7.2 and 7.3 as trials: what is run, and how a run is scored.
//
// Every trial is the 30 degree sine at 0.4 Hz in torque mode under the same PID; what differs is
// what is added to it, the pressure, and the load. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "tools/tracking/tracking.h"

namespace sinew::control_test {

enum class Arm {
  kPid,
  kLinear,   // + (7.1)
  kNetwork,  // + networks by regime, as trained
  kAdapted,  // + the same, adapted by RLS while it runs
  kInverse,  // + the true inverse of the surrogate: the bound
};
const char* ArmName(Arm arm);   // "network"
const char* ArmTitle(Arm arm);  // "PID + networks by regime"

enum class Load {
  kNone,
  kExternal,  // a payload that nobody declared, from the start
  kChanging,  // the same, put on during the run
};
const char* LoadTitle(Load load);

inline constexpr double kPayload_kg = 0.5;
inline constexpr double kFrequency_Hz = 0.4;
inline constexpr double kSoftStart_s = 2.5;  // delay and soft start of the reference
// Before the scored cycles, for every arm: after a minute's rest the link breaks away at 1.22 Nm,
// and what that leaves in the integral has nothing to do with the strategies.
inline constexpr double kLeadInCycles = 2.0;
inline constexpr double kStart_s = kSoftStart_s + kLeadInCycles / kFrequency_Hz;
inline constexpr double kLateCycles = 2.0;        // "late": the last cycles
inline constexpr double kChangeAfter_cycles = 3;  // kChanging

struct Trial {
  Arm arm = Arm::kPid;
  double pressure_bar = 4.0;
  Load load = Load::kNone;
  int cycles = 4;
  std::uint64_t seed = 101;

  double end_s() const { return kStart_s + cycles / kFrequency_Hz; }
  double duration_s() const { return end_s() + 1.5; }  // soft stop
  double payload_from_s() const {
    return load == Load::kChanging ? kStart_s + kChangeAfter_cycles / kFrequency_Hz : 0.0;
  }
  std::string name() const;  // a file name, unique
};

// The published run, each arm with each seed; adapted networks are not among the published arms.
std::vector<Trial> BenchmarkTrials(const std::vector<std::uint64_t>& seeds);
// Arms PID, network, adapted, inverse over pressures and loads: 8 cycles.
std::vector<Trial> GridTrials(const std::vector<double>& pressures_bar,
                              const std::vector<Load>& loads, const std::vector<Arm>& arms,
                              std::uint64_t seed);

struct TrialScore {
  tools::TrackingScore whole;        // all scored cycles
  double from_rest_mse_rad2 = 0.0;   // the lead-in with them
  double late_mse_rad2 = 0.0;        // the last cycles
  double motor_torque_rms_Nm = 0.0;  // at the shaft, from the measured current
  double positive_work_J = 0.0;      // at the shaft: integral of max(torque x speed, 0)
  double saturated_share = 0.0;      // samples within 2 % of the current limit
  // For pictures: every fourth sample, time from the start of the first cycle.
  std::vector<double> time_s, reference_rad, position_rad;
};

struct MotorFacts {
  double torque_constant_Nm_A = 0.0;
  double current_limit_A = 0.0;
};

// run: the recording of a trial. Throws std::invalid_argument when it is too short or lacks a
// signal.
TrialScore ScoreTrial(const Trial& trial, const types::Run& run, const MotorFacts& motor);

}  // namespace sinew::control_test

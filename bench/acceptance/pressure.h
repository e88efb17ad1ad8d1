// The pressure manager on the surrogate's air supply: pressures and stiffnesses held, relays
// spared, faults reported.
//
// Assessed by the surrogate's truth: the chamber's real pressure from when the manager
// first reports settled. Pure; deterministic for a seed.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "components/robot/pneumatics/manager.h"

namespace sinew::acceptance {

// Required: the true pressure stays this near to its target while it is held.
inline constexpr double kBand_bar = 0.05;
// Air that cools after filling is topped up; a filling that makes a venting necessary is hunting.
inline constexpr double kMostReversals_per_min = 1.0;
// Least times of the relays are kept to half a sample.
inline constexpr double kLeastMargin_s = -0.5 / 240.0;

struct HoldCase {
  pneumatics::HoldWith hold_with = pneumatics::HoldWith::kReservoir;
  double from_bar = 1.0;
  double target_bar = 4.0;
  double target_stiffness_Nm_rad = 0.0;  // more than 0: through the table, in target_bar's place
  bool moving = false;                   // the link swings 30 degrees at 0.4 Hz
  double seconds = 60.0;
  std::uint64_t seed = 1;
};

struct HoldScore {
  HoldCase at;
  double target_bar = 0.0;  // that the manager chose
  double reached_s = 0.0;   // settled for the first time
  bool settled = false;
  double worst_bar = 0.0;         // true pressure off its target, from half a second after that on
  double switches_per_min = 0.0;  // of all relays, from then on
  int reversals = 0;              // fillings after ventings and the other way: hunting
  double shortest_on_s = 0.0;     // of any relay against its own least time: the smallest excess
  double shortest_off_s = 0.0;
  pneumatics::Fault fault = pneumatics::Fault::kNone;
  double reversals_per_min() const { return 60.0 * reversals / at.seconds; }
  double least_margin_s() const { return std::min(shortest_on_s, shortest_off_s); }
};

HoldScore RunHoldCase(const pneumatics::ManagerConfig& config, const HoldCase& at);

// What breaks, 20 s after the start, at 4 bar.
enum class Breakage {
  kNothing,
  kLeak,            // a hole beside the seal
  kValveStuckShut,  // its contact says so
  kValveStuckOpen,
  kValveStuckMute,   // shut while its contact says open; another pressure is asked for
  kCompressorDead,   // a higher pressure is asked for
  kCompressorStuck,  // runs on
  kVentStuckShut,    // a lower pressure is asked for
  kSensorHigh,
  kSensorLow,
  kSensorBroken,  // not a number
};
const char* BreakageTitle(Breakage breakage);

struct FaultScore {
  Breakage breakage = Breakage::kNothing;
  pneumatics::Fault fault = pneumatics::Fault::kNone;
  double reported_after_s = 0.0;
  double highest_bar = 0.0;  // true pressure afterwards
  bool safe = false;         // safe mode in the same step, the compressor off, and so until the end
};

FaultScore RunFaultCase(const pneumatics::ManagerConfig& config, Breakage breakage);

struct PressureCheck {
  std::vector<HoldScore> holds;
  std::vector<FaultScore> faults;
};

std::vector<HoldCase> HoldCases(bool quick);
std::vector<Breakage> Breakages();

// Runs all of it on the manager of `config`. `progress` is called after each case with the numbers
// of cases done and to do; it may be empty. seed: of everything random, 1 and up.
PressureCheck MeasurePressure(const pneumatics::ManagerConfig& config, bool quick,
                              std::uint64_t seed,
                              const std::function<void(std::size_t, std::size_t)>& progress = {});

// The fault that the breakage is, and the safe state; no fault where nothing breaks.
bool IsRight(const FaultScore& score);

}  // namespace sinew::acceptance

// The regime detector on the surrogate, assessed by the surrogate's truth about its teeth, over a
// grid of motions, pressures and sensor noise.
//
// A sample is wrong when the detector's contact is not the true one, except
//   - within one sample of a true transition;
//   - while the teeth are apart by less than two counts of the output encoder: whichever of the two
//     is later is the time a transition has to be found.
// A change that the detector makes to a wrong state is false: chatter. Contacts shorter than two
// samples (bounces) are no transitions that 240 Hz could show. Pure; deterministic for a seed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "components/robot/regime/detector.h"

namespace sinew::acceptance {

// A count of the encoders: 14 bits.
inline constexpr double kCount_rad = 2.0 * std::numbers::pi / 16384.0;
// Required of every case: right outside one sample of a transition.
inline constexpr double kRightShare = 0.995;

enum class Motion {
  kHand,   // rotor locked, a hand pushes the link through the play
  kMotor,  // the motor turns to and fro, a hand pulls the load through zero
};

struct RegimeCase {
  Motion motion = Motion::kMotor;
  double speed_rad_s = 0.0;  // of the output, kMotor; rate of pushes in Hz, kHand
  double pressure_bar = 4.0;
  double noise_rad = 1.5e-4;  // of the output encoder
  double seconds = 20.0;
  std::uint64_t seed = 1;
};

struct RegimeScore {
  RegimeCase at;
  long samples = 0;
  long wrong = 0;
  long unknown = 0;
  long transitions = 0;  // true ones of two samples at least
  long found = 0;        // of these, in time
  long never = 0;        // over before they were found
  long latest = 0;       // most samples after the time
  long false_changes = 0;
  double right_share() const {
    return samples > 0 ? 1.0 - static_cast<double>(wrong) / static_cast<double>(samples) : 0.0;
  }
};

RegimeScore RunRegimeCase(const RegimeCase& at);

// The setup of Fig 7.1 on the surrogate, with the motor's encoder off by offset_rad (at the
// output).
struct SetupCase {
  double pressure_bar = 4.0;
  double offset_rad = 0.0;
  double noise_rad = 1.5e-4;
  std::uint64_t seed = 1;
};
struct SetupScore {
  SetupCase at;
  bool done = false;
  double error_rad = 0.0;           // of the contact that was found
  double reported_error_rad = 0.0;  // its standard error, as the detector reports it
  double seconds = 0.0;
  regime::Trouble trouble = regime::Trouble::kNone;
};
SetupScore RunSetupCase(const SetupCase& at);

// What must be reported as unknown: the name, and the share of samples that were.
struct UnknownCase {
  std::string name;
  double unknown_share = 0.0;  // from when it could be known
  double reported_after_s = 0.0;
};
std::vector<UnknownCase> RunUnknownCases();

struct RegimeGrid {
  std::vector<RegimeScore> scores;
  std::vector<SetupScore> setups;
  std::vector<UnknownCase> unknowns;
};

std::vector<RegimeCase> RegimeCases(bool quick);
std::vector<SetupCase> SetupCases(bool quick);

// Runs all of it. `progress` is called after each case with the numbers of cases done and to do; it
// may be empty. seed: of everything random, 1 and up.
RegimeGrid MeasureRegime(bool quick, std::uint64_t seed,
                         const std::function<void(std::size_t, std::size_t)>& progress = {});

// All cases of one noise level of the output encoder.
struct NoiseLevel {
  double noise_rad = 0.0;
  RegimeScore sum;
  double worst_share = 1.0;  // the least right_share of a case
  long cases = 0;
};
std::vector<NoiseLevel> ByNoise(const RegimeGrid& grid);

}  // namespace sinew::acceptance

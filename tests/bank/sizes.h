// How large an effect is in the bank, and with what it shares a class: fixed beforehand, by
// `bank_bench --calibrate`, on specimens that the bank does not use.
#pragma once

#include <string>
#include <vector>

#include "components/actuator/model.h"
#include "components/identify/design.h"
#include "sim/surrogate/excitation.h"
#include "tests/bank/scene.h"

namespace sinew::bank {

enum class Strength { kWeak, kStrong };

// What the size was made to reach.
enum class Sizing {
  kResidual,  // 10 % (weak) or 30 % of the residual variance left after a refit
  kShift,     // a refit swallows it: the largest shift of a declared parameter is 2 or 4 tolerances
  kPlain,     // neither in the balance of torques: the surrogate's default, weak 58 % of it
};

struct SizeOf {
  std::string effect;
  surrogate::ExcitationKind excitation = surrogate::ExcitationKind::kDesigned;
  Sizing sizing = Sizing::kResidual;
  double weak = 0.0, strong = 0.0;                  // in the surrogate's unit
  double weak_reached = 0.0, strong_reached = 0.0;  // share, or tolerances
  std::vector<std::string> rivals;                  // the class without the effect itself
};

// The table in sizes.inc. Throws std::out_of_range for what is not in it.
const SizeOf& FindSize(const std::string& effect, surrogate::ExcitationKind excitation);

// Makes one row of it, by a few iterations of size^2 ~ variance: the share of the refitted declared
// model's residual variance that the true structure takes away on the same recordings (where there
// is none to fit, that is missing in the twin of the same seeds without the effect); classes from
// recordings without noise.
SizeOf Calibrate(const std::string& effect, surrogate::ExcitationKind excitation);

// The row as it stands in sizes.inc.
std::string FormatSize(const SizeOf& size);

// Designs of a recording with its declared model.
identify::Design MakeTrainDesign(const Recorded& recorded,
                                 const identify::ProcessingOptions& processing);

}  // namespace sinew::bank

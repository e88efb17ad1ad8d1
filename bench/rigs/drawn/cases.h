// The cases of a rig: undeclared effects of its recordings, drawn from its number.
#pragma once

#include <string>
#include <vector>

#include "bench/rigs/drawn/declared.h"
#include "bench/rigs/drawn/motion.h"
#include "bench/rigs/drawn/sensors.h"
#include "bench/rigs/drawn/undeclared.h"

namespace sinew::rigs {

// kHidden: an effect of the size that designed motion asks for, in a motion that does not show it.
// kPlanted: of a size that is given, not drawn (bench/rigs/planting.h).
enum class CaseKind { kPlain, kEffect, kPair, kOutside, kIgnorance, kFault, kHidden, kPlanted };
const char* WordOf(CaseKind kind);

struct Case {
  std::string name;  // of its folder: 000123-2-effect-strong-designed
  CaseKind kind = CaseKind::kPlain;
  Excitation excitation = Excitation::kDesigned;
  double share = 0.0;  // requested of each effect; 0: none
  // Names; of one effect: the first that reaches the share (kHidden: and hides).
  std::vector<std::string> effects;
  std::string fault;
};

// In a fixed order; the same for the same number.
std::vector<Case> DrawCases(const Rig& rig);

// Faults of the log. Some are of the model file: `missing_constant` leaves the gear ratio out.
std::vector<std::string> FaultsOf(const Rig& rig);
struct FaultRows {
  std::string recording;    // train_1, ..., held_out
  int first = 0, last = 0;  // rows of the file, from 0, both included
};
// Plants the fault into the readings of the four recordings; which rows it spoilt.
std::vector<FaultRows> PlantFault(const Rig& rig, const std::string& fault,
                                  std::vector<std::vector<Reading>>& recordings);

const char* RecordingName(int recording);

// Names that are equivalent for a moving joint by definition, whatever the rig: rows of names.
const std::vector<std::vector<std::string>>& SameByDefinition();

}  // namespace sinew::rigs

// Errors of three models: as declared, the same refitted, and corrected by what was found. The
// balances and the simulation, training and held-out recordings. Pure.
#pragma once

#include <string>
#include <vector>

#include "components/model/report/report.h"

namespace sinew::report {

struct ErrorLine {
  std::string key;   // "train", "held_out", "simulated"
  std::string what;  // for people, e.g. "held-out recordings, kinematic balance"
  effects::Balance balance = effects::Balance::kMotion;
  std::string unit;
  // rms; NaN: the simulated model diverged.
  double declared = 0.0, refitted = 0.0, corrected = 0.0;
};

// Training and held-out error of every balance with a result, and the simulated position's.
std::vector<ErrorLine> ErrorTable(const Report& report);

// Held-out and simulated errors that the corrected model raises over the declared or the refitted
// one by more than the rule `raises` allows (trace/rules.h).
std::vector<ErrorLine> Rises(const Report& report);
// One sentence about them; empty without any.
std::string RiseSentence(const Report& report);

// "0.0487", "diverged".
std::string ErrorText(double error);
// "0.0512 declared, 0.0487 refitted, 0.0421 Nm corrected".
std::string ThreeErrors(const ErrorLine& line);

}  // namespace sinew::report

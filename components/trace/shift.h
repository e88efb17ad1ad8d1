// What a refit swallowed: shifts of declared parameters beyond their tolerance, and the effects
// that would shift them the same way.
#pragma once

#include <string>
#include <vector>

#include "components/identify/fit.h"
#include "components/trace/candidates.h"
#include "components/trace/tracer.h"

namespace sinew::trace {

struct SwallowedCause {
  Candidate candidate;
  double theta = 0.0;  // size that explains the shifts
  double half_width_95 = 0.0;
  double before = 0.0;  // sum of squared shifts, in tolerances
  double after = 0.0;
};

struct ShiftReport {
  std::vector<ParameterShift> shifts;  // every declared parameter that moved by a tolerance or more
  std::vector<SwallowedCause>
      causes;  // effects that explain shifts of two or more parameters; best first
};

// nominal: the model as declared; fit: the final fit (same declared terms, maybe more).
ShiftReport FindShifts(const identify::Design& design, const actuator::JointModel& nominal,
                       const identify::FitResult& fit, const std::vector<Candidate>& candidates);

}  // namespace sinew::trace

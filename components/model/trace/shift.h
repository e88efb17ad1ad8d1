// Effects absorbed by refitting: shifts of declared parameters beyond their tolerance, and the
// effects that would shift them the same way.
#pragma once

#include <vector>

#include "components/model/identify/balance.h"
#include "components/model/trace/candidates.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

// Every declared parameter that moved by a tolerance or more.
// nominal: the model as declared; fit: the final fit (same declared terms, maybe more).
std::vector<ParameterShift> FindShifts(const identify::Design& design,
                                       const actuator::JointModel& nominal,
                                       const identify::FitResult& fit,
                                       const std::vector<Candidate>& candidates);

}  // namespace sinew::trace

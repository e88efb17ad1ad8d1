// The declared terms as they are reported, the errors of the models without an effect, and what the
// search comes to. Pure but for the designs' predicted drive; allocates.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "components/model/trace/problem.h"
#include "components/model/trace/trace_result.h"

namespace sinew::trace {

// The declared terms without whitening (Unweighted). Rigid bodies of an arm stay as all joints
// together gave them: what a refit of them would take is no part of a joint's model.
LikelihoodFit Reported(const identify::Design& train, const LikelihoodFit& base,
                       const actuator::JointModel& declared);

// used: rows of the search.
RowUsage UsageOf(const identify::Design& train, const UsedRows& used);

// Errors of result->nominal and of the reported fit, noise floor and ceiling. The drive that terms
// read is the one that each model predicts; at the end that of `drive`.
void NoteErrors(const LikelihoodFit& reported, const actuator::JointModel& drive,
                identify::Design* predicted_train, identify::Design* predicted_held_out,
                TraceResult* result);

// Accepted is what is in the model; the rest names its rule.
void NoteOutcome(const TraceResult& result, std::vector<CandidateScore>* scores);
// Effects that are found or open.
std::set<std::string> Shown(const TraceResult& result);
// By what is found, open, refuted and unexplained.
Verdict VerdictOf(const TraceResult& result);

}  // namespace sinew::trace

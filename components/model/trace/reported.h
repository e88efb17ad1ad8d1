// The declared terms as they are reported, the errors of the models without an effect, and what the
// search comes to. Pure but for the designs' predicted drive; allocates.
#pragma once

#include <string>
#include <vector>

#include "components/model/trace/candidates.h"
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

// Conclusions from the effects that are found, open and refuted: which candidates are accepted and
// which rule refused the others; by the detectable sizes what the recordings could not have shown;
// the verdict. problem: of the search.
void Conclude(const Problem& problem, TraceResult* result);

// The part of a residual that is noise of the sensors.
struct NoiseFloor {
  double rms = 0.0;    // torque at the output, after the parallel filter; 0: unknown
  std::string source;  // "standstill", "sample-to-sample scatter", ""
};

// From spells at rest (drive and known torques, straight line removed from each), and from the
// scatter of the drive from sample to sample, taken as white: the lower one.
NoiseFloor EstimateNoiseFloor(const identify::Design& design, const identify::Balance& balance,
                              double drive_factor);

// Effects absorbed by refitting (shift.cc). Shifts of declared parameters by a tolerance or more,
// and the effects that would shift them the same way.
// nominal: the model as declared; fit: the final fit (same declared terms, maybe more).
std::vector<ParameterShift> FindShifts(const identify::Design& design,
                                       const actuator::JointModel& nominal,
                                       const identify::FitResult& fit,
                                       const std::vector<Candidate>& candidates);

}  // namespace sinew::trace

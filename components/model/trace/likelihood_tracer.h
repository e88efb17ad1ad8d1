// From the residual of a balance to the effects that it lacks, by one likelihood at the raw rate.
//
// Steps (docs/closing-the-loop.md): the declared terms are fitted with their priors; noise is
// estimated from the residual of the richest model and whitened; effects of the catalogue, lines of
// the order spectrum and free curves compete as sets; one p-value opens the search and further ones
// each further effect; what training selected is confirmed or refuted on the held-out recordings.
// Pure; allocates; reads no clock; the seed decides the signs of the bootstrap.
#pragma once

#include "components/model/trace/trace_result.h"

namespace sinew::trace {

// train, held-out: raw rows (identify::Unfiltered); they are changed: their predicted drive follows
// the model. other_band: train behind another low-pass of the angles (CompareBands); may be null.
TraceResult TraceByLikelihood(identify::Design& train, identify::Design& held_out,
                              const actuator::JointModel& model, const TraceOptions& options,
                              identify::Design* other_band = nullptr);

}  // namespace sinew::trace

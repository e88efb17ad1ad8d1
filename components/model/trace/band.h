// Width that the low-pass of the angles has to have. What it cuts off of the motion stays in the
// balance as an error, and so does the noise of the acceleration that it lets pass: the width is
// that of the least residual of the declared terms, by least squares, at the rows that both widths
// use.
//
// Wider in steps of sqrt(2) while the residual falls by more than three tenths: a step makes the
// noise of an acceleration 2.4 times as loud, and where it was a third of the residual, the gain is
// lost. A smaller gain may be a drive that answers to that noise (a servo's command does).
//
// Otherwise narrower. With an encoder on the motor down to half, while the residual falls at all
// with every effect of the catalogue beside the declared terms (what an effect leaves is no noise:
// without them a late pressure sensor was cut off): where teeth touch, its angle holds impacts that
// a wide low-pass spreads (an eighth cost 4 of 10 names in task motion on another rig). With one
// encoder down to an eighth, while the residual falls by more than a tenth: noise of the
// acceleration; less may be the motion itself. There it begins no narrower than what the held-out
// motion needs (identify::QuietBand, which reads no residual): training that is slower than what
// comes later would cut that off, as with the pulses of EMPS. Pure; allocates.
#pragma once

#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing_settings.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

// As identify::FromMotion of the training recordings, which it starts from.
identify::ProcessingOptions BandOfLeastResidual(const std::vector<types::Run>& train,
                                                const std::vector<types::Run>& held_out,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s, const InForce& in_force);

// Time after a contact of the teeth in which the residual of the declared terms is louder than far
// away from it, by more than a tenth, s; 0: it is not, or the gear is rigid. At most so long that
// two thirds of the rows remain.
double ContactGuard(const std::vector<types::Run>& train, const actuator::JointModel& joint,
                    const identify::ProcessingOptions& options);

}  // namespace sinew::trace

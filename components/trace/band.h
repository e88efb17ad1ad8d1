// How wide the low-pass of the angles has to be. What it cuts off of the motion stays in the
// balance as an error, and so does the noise of the acceleration that it lets pass: the width is
// that of the least residual of the declared terms, by least squares, at the rows that both widths
// use.
//
// Wider in steps of sqrt(2) while the residual falls by more than three tenths: a step makes the
// noise of an acceleration 2.4 times as loud, and where it was a third of the residual, the gain is
// lost. A smaller gain may be a drive that answers to that noise (a servo's command does).
//
// Otherwise narrower, down to half, while the residual falls at all: where teeth touch, the motor's
// angle holds impacts that a wide low-pass spreads. Only with an encoder on the motor: where one
// encoder tells all of the motion, training that is slower than what comes later would cut that off
// (the pulses of EMPS were predicted a third worse). Pure; allocates.
#pragma once

#include <vector>

#include "components/actuator/model.h"
#include "components/identify/processing_settings.h"
#include "components/identify/run.h"

namespace sinew::trace {

// As identify::FromMotion, which it starts from.
identify::ProcessingOptions BandOfLeastResidual(const std::vector<identify::Run>& runs,
                                                const actuator::JointModel& joint,
                                                double longest_gap_s);

}  // namespace sinew::trace

// How wide the low-pass of the angles has to be. Noise alone asks for a narrow one; where the
// motion goes on beyond it, what it cuts off stays in the balance as an error that is larger than
// the noise it keeps out. So the band is widened in steps of sqrt(2) while the least-squares
// residual of the declared terms falls by more than three tenths: a step makes the noise of an
// acceleration 2.4 times as loud, and where it was a third of the residual, the gain is lost.
// Pure; allocates.
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

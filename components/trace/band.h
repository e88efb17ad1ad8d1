// How wide the low-pass of the angles has to be. Noise alone asks for a narrow one; where the
// motion goes on beyond it, what it cuts off stays in the balance as an error that is larger than
// the noise it keeps out. So the band is widened in steps of sqrt(2) while the least-squares
// residual of the declared terms falls by more than a tenth. Pure; allocates.
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

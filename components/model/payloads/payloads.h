// Payloads of a model file on the bodies of its URDF: point masses fixed to links. Pure; allocates.
#pragma once

#include <vector>

#include "components/bodies/links/bodies.h"
#include "components/model/actuator/model.h"

namespace sinew::arm {

// The chain with each payload added to its link (AddPointMass). Throws std::invalid_argument naming
// the payload's link: one that the chain lacks, a mass not above 0, a value that is not finite.
Chain WithPayloads(Chain chain, const std::vector<actuator::Payload>& payloads);

}  // namespace sinew::arm

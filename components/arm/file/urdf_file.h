// A URDF read as plain bodies and joints: a tree on a fixed base, revolute, continuous, prismatic
// and fixed joints. Throws UsageError, one line naming file, line and element, for everything that
// cannot be simulated: bad XML, a missing or impossible inertia, a floating joint.
#pragma once

#include <string>

#include "components/arm/bodies.h"

namespace sinew::arm {

// file_name stands for the file in messages.
Chain ParseUrdf(const std::string& xml, const std::string& file_name);

}  // namespace sinew::arm

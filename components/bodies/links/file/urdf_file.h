// A URDF read as plain bodies and joints: a tree of revolute, continuous, prismatic and fixed
// joints. An element `passive` of the robot names a joint without a drive, its stiffness and
// damping (Body::passive); such a joint has effort 0 and no transmission. Throws UsageError, one
// line naming file, line and element, for everything that cannot be simulated: bad XML, a missing
// or impossible inertia, a floating joint.
#pragma once

#include <string>

#include "components/bodies/links/bodies.h"

namespace sinew::arm {

// Links of a URDF: eighty fixed frames for each of types::kMaxJoints moving joints. They are
// visited by recursion, below 1 KiB of stack for each.
inline constexpr int kMostLinks = 1000;

// file_name stands for the file in messages. The inertia of the base link is copied as it stands:
// it matters to a floating base only (FloatingChain checks it).
Chain ParseUrdf(const std::string& xml, const std::string& file_name);

}  // namespace sinew::arm

// A URDF read as plain bodies and joints: a tree of revolute, continuous, prismatic and fixed
// joints. An element `passive` of the robot names a joint without a drive, its stiffness and
// damping (Body::passive); such a joint has effort 0 and no transmission. Throws UsageError, one
// line naming file, line and element, for everything that cannot be simulated: bad XML, a missing
// or impossible inertia, of the base link as well, a floating joint.
//
// A joint that mimics one that itself mimics another follows the last (Body::mimic), whose stops
// are narrowed to those of all that follow it. On a fixed joint `mimic` says nothing.
#pragma once

#include <string>

#include "components/bodies/links/bodies.h"

namespace sinew::arm {

// Links of a URDF: eighty fixed frames for each of types::kMaxJoints moving joints. They are
// visited by recursion, below 1 KiB of stack for each.
inline constexpr int kMostLinks = 1000;

// file_name stands for the file in messages.
Chain ParseUrdf(const std::string& xml, const std::string& file_name);

}  // namespace sinew::arm

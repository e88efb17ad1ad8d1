// The largest number of joints of a robot, and arrays with one entry for each joint.
//
// The limit is that of the topics: the IDL types have arrays of 12 (idl/joint.idl). A test compares
// the two.
#pragma once

#include <array>

namespace sinew::types {

inline constexpr int kMaxJoints = 12;

// Entry j belongs to joint j. A robot with fewer joints uses the first entries.
template <typename T>
using JointArray = std::array<T, kMaxJoints>;

}  // namespace sinew::types

// The section `squat` of `schema: sinew-reference/1` (docs/participants/reference.md): a
// trajectory for every driven joint of a robot with two legs. Throws UsageError; a passed limit is
// one, with joint, limit and the largest value.
#pragma once

#include "components/base/config/config.h"
#include "components/robot/reference/file/reference_file.h"

namespace sinew::reference {

// Fills joints, joint_names and notes. Driven joints are those that move and whose effort in the
// URDF is above 0; those that take no part in the squat are held at 0.
void DescribeSquat(config::Fields& fields, LoadedReference* loaded);

}  // namespace sinew::reference

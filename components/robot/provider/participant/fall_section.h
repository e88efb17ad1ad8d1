// The section `fall` of a `guard:` block: a robot on two legs is watched for falls.
//
// The URDF gives the legs (components/bodies/leg/geometry.h; joints left_hip_yaw and so on, links
// left_sole, right_sole), the mass, and the mounting of the link imu, which is fixed to the base.
// The robot's joints, as the topics number them, are the URDF's driven ones in its order: those
// that move and whose effort is above 0.
#pragma once

#include "components/base/config/fields.h"
#include "components/robot/provider/fall_guard.h"

namespace sinew::provider {

// Throws UsageError, one line with file and key.
void Describe(config::Fields& fields, FallGuardConfig& config);

}  // namespace sinew::provider

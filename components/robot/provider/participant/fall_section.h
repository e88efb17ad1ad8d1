// The section `fall` of a `guard:` block: a robot on two legs is watched for falls.
//
//   fall:
//     urdf: biped.urdf         # relative to this file
//     on_fall: idle            # or damp
//     start_within_s: 10       # an armed robot whose detector has not started by then has a fault
//     pendulum_length_m: 1.0   # foot to highest mass
//     imu:                     # bounds of the robot's part (components/robot/fall/imu_check.h)
//       force_range_m_s2: 19.62
//       force_bias_m_s2: 0.7
//       force_noise_m_s2: 0.05
//       rate_range_rad_s: 8.73
//       rate_bias_rad_s: 0.61
//       rate_drift_rad_s2: 3.4e-5
//       rate_noise_rad_s: 1.7e-3
//       rate_scale_error: 0.03
//
// The URDF gives the legs (components/bodies/leg/geometry.h; joints left_hip_yaw and so on, links
// left_sole, right_sole), the mass, and the mounting of the link imu, which is fixed to the base.
// The robot's joints, as the topics number them, are the URDF's driven ones in its order: those
// that move and whose effort is above 0.
#pragma once

#include <memory>

#include "components/base/config/config.h"
#include "components/robot/provider/fall_guard.h"

namespace sinew::provider {

// Throws UsageError, one line with file and key. The caller rejects unknown keys of the section.
FallGuardConfig ReadFallGuard(const config::Section& fall);

}  // namespace sinew::provider

// The surrogate's configuration for tests and benches of CAN: motors alone, viscous enough to rest
// soon after their torque has gone, in steps as long as the surrogate allows, so that physics is
// not what keeps the machine busy.
#pragma once

namespace sinew::testing {

inline constexpr const char* kMotorsAlone =
    "schema: sinew-surrogate/1\ninitial_rest_s: 0.0\nstep_s: 1.0e-4\n"
    "motor: {viscous_Nm_s_rad: 3.0e-4,"
    " drive: {rate_Hz: 500, estimator_bandwidth_rad_s: 200}}\n"
    "gear: {play_rad: 1000000.0, torque_share_drive_1: 1.0, torque_share_back_1: 1.0}\n"
    "link: {gravity_torque_Nm: 0.0}\npneumatics: {initial_pressure_bar: 0.0}\n";

}  // namespace sinew::testing

// Rows of an experiment as the lab's CSV: time_s, motor_angle_rad, motor_velocity_rad_s,
// output_angle_rad, output_velocity_rad_s, motor_current_A, chamber_pressure_bar, load_force_N,
// valve_open, payload_kg, motor_temperature_degC. Not for loops.
#pragma once

#include <string>
#include <vector>

#include "sim/surrogate/experiment.h"

namespace sinew::surrogate {

std::string RowsToCsv(const std::vector<LogRow>& rows);

}  // namespace sinew::surrogate

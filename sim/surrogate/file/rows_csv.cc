#include "sim/surrogate/file/rows_csv.h"

#include <cstdio>

namespace sinew::surrogate {

std::string RowsToCsv(const std::vector<LogRow>& rows) {
  std::string text =
      "time_s,motor_angle_rad,motor_velocity_rad_s,output_angle_rad,output_velocity_rad_s,"
      "motor_current_A,chamber_pressure_bar,load_force_N,valve_open,payload_kg,motor_temperature_"
      "degC\n";
  char line[256];
  for (const LogRow& row : rows) {
    const int length = std::snprintf(
        line, sizeof line, "%.5f,%.6f,%.4f,%.6f,%.5f,%.4f,%.5f,%.4f,%d,%.3f,%.1f\n", row.time_s,
        row.motor_angle_rad, row.motor_velocity_rad_s, row.output_angle_rad,
        row.output_velocity_rad_s, row.motor_current_A, row.chamber_pressure_bar, row.load_force_N,
        row.valve_open ? 1 : 0, row.payload_kg, row.motor_temperature_degC);
    text.append(line, static_cast<std::size_t>(length));
  }
  return text;
}

}  // namespace sinew::surrogate

#include "components/model/experiment/rows.h"

#include <cstdio>

namespace sinew::experiment {

Recording RowsOfRun(const types::Run& run, double from_s) {
  using types::Signal;
  const Eigen::VectorXd& position = run.At(Signal::kPosition);
  const Eigen::VectorXd& motor = run.At(Signal::kMotorPosition);
  const Eigen::VectorXd& current = run.At(Signal::kMotorCurrent);
  const auto value = [&run](Signal signal, Eigen::Index i) {
    return run.Has(signal) ? run.signals.at(signal)(i) : 0.0;
  };
  Recording rows;
  for (Eigen::Index i = 0; i < run.size(); ++i) {
    if (run.time_s(i) < from_s) continue;
    Row row;
    row.time_s = run.time_s(i) - from_s;
    row.motor_angle_rad = motor(i);
    row.motor_velocity_rad_s = value(Signal::kMotorVelocity, i);
    row.output_angle_rad = position(i);
    row.output_velocity_rad_s = value(Signal::kVelocity, i);
    row.motor_current_A = current(i);
    row.chamber_pressure_bar = value(Signal::kChamberPressure, i);
    row.reservoir_pressure_bar = value(Signal::kReservoirPressure, i);
    row.load_force_N = value(Signal::kLoadForce, i);
    row.valve_open = value(Signal::kValveOpen, i) > 0.5;
    rows.push_back(row);
  }
  return rows;
}

std::string FormatCsv(const Recording& rows) {
  std::string text =
      "time_s,motor_angle_rad,motor_velocity_rad_s,output_angle_rad,output_velocity_rad_s,"
      "motor_current_A,chamber_pressure_bar,reservoir_pressure_bar,load_force_N,valve_open\n";
  char line[256];
  for (const Row& r : rows) {
    std::snprintf(line, sizeof line, "%.6f,%.6f,%.4f,%.7f,%.5f,%.4f,%.5f,%.5f,%.4f,%d\n", r.time_s,
                  r.motor_angle_rad, r.motor_velocity_rad_s, r.output_angle_rad,
                  r.output_velocity_rad_s, r.motor_current_A, r.chamber_pressure_bar,
                  r.reservoir_pressure_bar, r.load_force_N, r.valve_open ? 1 : 0);
    text += line;
  }
  return text;
}

}  // namespace sinew::experiment

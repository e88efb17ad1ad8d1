#include "components/robot/pneumatics/file/pneumatics_file.h"

#include "components/base/types/joints.h"

namespace sinew::pneumatics {

using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, RelayTimes& c) {
  f("min_on_s", c.min_on_s, kNotNegative, "least time on");
  f("min_off_s", c.min_off_s, kNotNegative, "least time off");
}

// Sets the pressure, stated as it is or by the stiffness that it gives.
static void DescribeTarget(config::Fields& f, ManagerConfig& c) {
  f.If("stiffness", "stiffness by pressure, as identified", [&](config::Fields& table) {
    std::vector<double> pressure_bar, stiffness_Nm_rad;
    table.Need("pressure_bar", pressure_bar, kNotNegative, "rising");
    table.Need("stiffness_Nm_rad", stiffness_Nm_rad, kNotNegative, "one for each pressure");
    table.Check("pressure_bar",
                [&] { c.stiffness = StiffnessTable(pressure_bar, stiffness_Nm_rad); });
  });
  std::optional<double> given_bar, given_Nm_rad;
  f("target_bar", given_bar, kNotNegative, "held until something else is asked for; 0");
  f("target_stiffness_Nm_rad", given_Nm_rad, kNotNegative, "in its place, inside the table");
  if (given_Nm_rad && given_bar) {
    f.Fail("target_stiffness_Nm_rad", "stands beside 'target_bar', expected only one of them");
  }
  if (given_Nm_rad) given_bar = c.stiffness.Pressure_bar(*given_Nm_rad);
  if (given_Nm_rad && !given_bar) {
    f.Fail("target_stiffness_Nm_rad",
           "is not in the table 'stiffness', expected a value inside it");
  }
  c.target_bar = given_bar.value_or(c.target_bar);
}

static void Describe(config::Fields& f, ManagerConfig& c) {
  f.Word("hold_with", c.hold_with,
         {{"reservoir", HoldWith::kReservoir}, {"chamber", HoldWith::kChamber}},
         "valve open, or shut between corrections");
  DescribeTarget(f, c);
  f("max_target_bar", c.max_target_bar, kPositive, "asked for more: this");
  f("band_bar", c.band_bar, kPositive, "settled inside it");
  std::optional<double> start_band_bar;
  f("start_band_bar", start_band_bar, kPositive, "a correction starts outside; 0.7 of band_bar");
  c.start_band_bar = start_band_bar.value_or(0.7 * c.band_bar);
  f("lead_s", c.lead_s, kNotNegative, "the pressure expected so much later ends a correction");
  f("settle_s", c.settle_s, kNotNegative, "between two corrections");
  f("calm_s", c.calm_s, kNotNegative, "chamber: before the valve shuts");
  f("filter_Hz", c.filter_Hz, kPositive, "low-pass of the pressures");
  f("valve", c.valve, "relay between reservoir and chamber");
  f("compressor", c.compressor, "its relay");
  f("vent", c.vent, "relay of the controlled leak");
  f("reservoir_sensor", c.reservoir_sensor, "the reservoir's pressure is measured, too");
  f("valve_feedback", c.valve_feedback, "the valve has a contact");
  f("vent_when_safe", c.vent_when_safe, "a fault lets the air out");
  f("vent_when_idle", c.vent_when_idle, "not active: lets the air out");
  f("sensor_lower_bar", c.sensor_lower_bar, "below it the sensor has a fault");
  f("sensor_upper_bar", c.sensor_upper_bar, "above it, too");
  f("sensor_time_s", c.sensor_time_s, kNotNegative, "after so long");
  f("max_pressure_bar", c.max_pressure_bar, kPositive, "overpressure above it");
  f("response_s", c.response_s, kPositive, "filling or venting moves the pressure in this time");
  f("response_bar", c.response_bar, kPositive, "by so much");
  f("feedback_time_s", c.feedback_time_s, kPositive, "the valve's contact may disagree so long");
  f("leak_limit_bar_s", c.leak_limit_bar_s, kPositive, "faster drift at rest is a fault");
  f("leak_window_s", c.leak_window_s, kPositive, "over which drift counts");
  f.Check("target_bar", [&] { static_cast<void>(PressureManager(c)); });
}

void Describe(config::Fields& f, PneumaticsConfig& c) {
  f("hold_disarmed", c.hold_disarmed, "holds pressure before the robot is armed, too");
  f("motion_requests", c.motion_requests, "awaited in every tick, for the pressure asked for");
  f("motion_timeout_s", c.motion_timeout_s, kPositive, "an older request has ended");
  f.Need("joints", c.joints, {1, types::kMaxJoints}, "in the order of joint_state");
}

PneumaticsConfig LoadPneumatics(const std::filesystem::path& path) {
  return config::Read<PneumaticsConfig>(config::Section::Load(path, kSchema));
}

}  // namespace sinew::pneumatics

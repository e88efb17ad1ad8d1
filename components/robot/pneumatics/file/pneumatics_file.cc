#include "components/robot/pneumatics/file/pneumatics_file.h"

#include "components/base/types/joints.h"

namespace sinew::pneumatics {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

RelayTimes ReadRelay(const Section& parent, std::string_view key, RelayTimes times) {
  const Section s = parent.ChildOrEmpty(key);
  times.min_on_s = s.NumberOr("min_on_s", times.min_on_s, kNotNegative);
  times.min_off_s = s.NumberOr("min_off_s", times.min_off_s, kNotNegative);
  s.RejectUnknownKeys();
  return times;
}

ManagerConfig ReadJoint(const Section& s) {
  ManagerConfig c;
  c.hold_with = s.ChoiceOr("hold_with", "reservoir", {"reservoir", "chamber"}) == "chamber"
                    ? HoldWith::kChamber
                    : HoldWith::kReservoir;
  c.max_target_bar = s.NumberOr("max_target_bar", c.max_target_bar, kPositive);
  c.max_pressure_bar = s.NumberOr("max_pressure_bar", c.max_pressure_bar, kPositive);
  c.band_bar = s.NumberOr("band_bar", c.band_bar, kPositive);
  c.start_band_bar = s.NumberOr("start_band_bar", 0.7 * c.band_bar, kPositive);
  c.lead_s = s.NumberOr("lead_s", c.lead_s, kNotNegative);
  c.settle_s = s.NumberOr("settle_s", c.settle_s, kNotNegative);
  c.calm_s = s.NumberOr("calm_s", c.calm_s, kNotNegative);
  c.filter_Hz = s.NumberOr("filter_Hz", c.filter_Hz, kPositive);
  c.valve = ReadRelay(s, "valve", c.valve);
  c.compressor = ReadRelay(s, "compressor", c.compressor);
  c.vent = ReadRelay(s, "vent", c.vent);
  c.reservoir_sensor = s.BoolOr("reservoir_sensor", c.reservoir_sensor);
  c.valve_feedback = s.BoolOr("valve_feedback", c.valve_feedback);
  c.vent_when_safe = s.BoolOr("vent_when_safe", c.vent_when_safe);
  c.vent_when_idle = s.BoolOr("vent_when_idle", c.vent_when_idle);
  c.sensor_lower_bar = s.NumberOr("sensor_lower_bar", c.sensor_lower_bar);
  c.sensor_upper_bar = s.NumberOr("sensor_upper_bar", c.sensor_upper_bar);
  c.sensor_time_s = s.NumberOr("sensor_time_s", c.sensor_time_s, kNotNegative);
  c.response_s = s.NumberOr("response_s", c.response_s, kPositive);
  c.response_bar = s.NumberOr("response_bar", c.response_bar, kPositive);
  c.feedback_time_s = s.NumberOr("feedback_time_s", c.feedback_time_s, kPositive);
  c.leak_limit_bar_s = s.NumberOr("leak_limit_bar_s", c.leak_limit_bar_s, kPositive);
  c.leak_window_s = s.NumberOr("leak_window_s", c.leak_window_s, kPositive);
  if (s.Has("stiffness")) {
    const Section table = s.Child("stiffness");
    const std::vector<double> pressure_bar = table.Numbers("pressure_bar", kNotNegative);
    const std::vector<double> stiffness_Nm_rad = table.Numbers("stiffness_Nm_rad", kNotNegative);
    table.RejectUnknownKeys();
    try {
      c.stiffness = StiffnessTable(pressure_bar, stiffness_Nm_rad);
    } catch (const std::invalid_argument& error) {
      s.Fail("stiffness", error.what());
    }
  }
  if (s.Has("target_stiffness_Nm_rad")) {
    if (s.Has("target_bar")) {
      s.Fail("target_stiffness_Nm_rad", "stands beside 'target_bar', expected only one of them");
    }
    const double stiffness_Nm_rad = s.Number("target_stiffness_Nm_rad", kNotNegative);
    const std::optional<double> pressure_bar = c.stiffness.Pressure_bar(stiffness_Nm_rad);
    if (!pressure_bar) {
      s.Fail("target_stiffness_Nm_rad",
             "is not in the table 'stiffness', expected a value inside it");
    }
    c.target_bar = *pressure_bar;
  } else {
    c.target_bar = s.NumberOr("target_bar", c.target_bar, kNotNegative);
  }
  s.RejectUnknownKeys();
  try {
    static_cast<void>(PressureManager(c));
  } catch (const std::invalid_argument& error) {
    throw UsageError(s.file().string() + ":" + std::to_string(s.line()) + ": " + error.what() +
                     ", expected figures that fit together (docs/participants/pneumatics.md)");
  }
  return c;
}

}  // namespace

PneumaticsConfig ReadPneumatics(const config::Section& section) {
  PneumaticsConfig config;
  config.hold_disarmed = section.BoolOr("hold_disarmed", false);
  config.motion_requests = section.BoolOr("motion_requests", false);
  config.motion_timeout_s =
      section.NumberOr("motion_timeout_s", config.motion_timeout_s, kPositive);
  const std::vector<Section> joints = section.List("joints");
  if (joints.empty() || joints.size() > types::kMaxJoints) {
    section.Fail("joints", "has " + std::to_string(joints.size()) + " entries, expected 1 to " +
                               std::to_string(types::kMaxJoints));
  }
  for (const Section& joint : joints) config.joints.push_back(ReadJoint(joint));
  section.RejectUnknownKeys();
  return config;
}

PneumaticsConfig LoadPneumatics(const std::filesystem::path& path) {
  return ReadPneumatics(Section::Load(path, "sinew-pneumatics/1"));
}

}  // namespace sinew::pneumatics

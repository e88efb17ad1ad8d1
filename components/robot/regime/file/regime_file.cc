#include "components/robot/regime/file/regime_file.h"

#include <algorithm>
#include <numbers>

#include "components/base/types/joints.h"

namespace sinew::regime {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

DetectorConfig ReadJoint(const Section& s) {
  DetectorConfig joint;
  joint.gear_ratio = s.Number("gear_ratio", kPositive);
  joint.play.backlash_rad = s.Number("backlash_rad", kPositive);
  const double counts = s.NumberOr("encoder_counts_per_turn", 16384.0, {64.0});
  joint.play.output_count_rad = 2.0 * std::numbers::pi / counts;
  joint.play.output_noise_rad =
      s.NumberOr("encoder_noise_rad", joint.play.output_noise_rad, kNotNegative);
  joint.play.hysteresis_counts =
      s.NumberOr("hysteresis_counts", joint.play.hysteresis_counts, kPositive);
  joint.play.sampling_skew_s = s.NumberOr("sampling_skew_s", 0.0, {0.0, 0.1});
  joint.inconsistent_rad = s.NumberOr("inconsistent_rad", joint.inconsistent_rad, kPositive);
  if (s.Choice("setup", {"given", "active"}) == "given") {
    joint.setup = Setup::kGiven;
    joint.play_center_rad = s.NumberOr("play_center_rad", 0.0);
  } else {
    joint.setup = Setup::kActive;
    joint.chamber_direction =
        s.ChoiceOr("chamber_pushes", "up", {"up", "down"}) == "up" ? 1.0 : -1.0;
    joint.setup_pressure_bar =
        s.NumberOr("setup_pressure_bar", joint.setup_pressure_bar, kPositive);
    joint.min_pressure_bar = s.NumberOr("min_pressure_bar", joint.min_pressure_bar, kPositive);
    joint.velocity_rad_s = s.NumberOr("setup_velocity_rad_s", joint.velocity_rad_s, kPositive);
    joint.motor_torque_limit_Nm =
        s.NumberOr("setup_torque_limit_Nm", joint.motor_torque_limit_Nm, kPositive);
    joint.travel_rad = s.NumberOr("setup_travel_rad", joint.travel_rad, kPositive);
    joint.contact_travel_rad =
        s.NumberOr("contact_travel_rad", joint.contact_travel_rad, kPositive);
    joint.timeout_s = s.NumberOr("setup_timeout_s", joint.timeout_s, kPositive);
  }
  s.RejectUnknownKeys();
  try {
    static_cast<void>(RegimeDetector(joint));
  } catch (const std::invalid_argument& error) {
    s.Fail("backlash_rad", error.what());
  }
  return joint;
}

}  // namespace

bool RegimeConfig::requests_motion() const {
  return std::any_of(joints.begin(), joints.end(),
                     [](const DetectorConfig& joint) { return joint.setup == Setup::kActive; });
}

RegimeConfig ReadRegime(const config::Section& section) {
  RegimeConfig config;
  const std::vector<Section> joints = section.List("joints");
  if (joints.empty() || joints.size() > types::kMaxJoints) {
    section.Fail("joints", "has " + std::to_string(joints.size()) + " entries, expected 1 to " +
                               std::to_string(types::kMaxJoints));
  }
  for (const Section& joint : joints) config.joints.push_back(ReadJoint(joint));
  section.RejectUnknownKeys();
  return config;
}

RegimeConfig LoadRegime(const std::filesystem::path& path) {
  return ReadRegime(Section::Load(path, "sinew-regime/1"));
}

}  // namespace sinew::regime

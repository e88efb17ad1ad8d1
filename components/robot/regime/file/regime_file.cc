#include "components/robot/regime/file/regime_file.h"

#include <algorithm>
#include <numbers>

#include "components/base/types/joints.h"

namespace sinew::regime {
using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, DetectorConfig& c) {
  f.Need("gear_ratio", c.gear_ratio, kPositive, "N");
  f.Need("backlash_rad", c.play.backlash_rad, kPositive, "full width at the output");
  double counts = 16384.0;
  f("encoder_counts_per_turn", counts, {64.0}, "of the output");
  c.play.output_count_rad = 2.0 * std::numbers::pi / counts;
  f("encoder_noise_rad", c.play.output_noise_rad, kNotNegative, "standard deviation of the output");
  f("hysteresis_counts", c.play.hysteresis_counts, kPositive, "between outside and inside");
  f("sampling_skew_s", c.play.sampling_skew_s, {0.0, 0.1},
    "motor and output sampled this far apart: more careful in fast motion");
  f("inconsistent_rad", c.inconsistent_rad, kPositive, "outside of the backlash: unknown");
  const auto setup =
      f.NeedWord("setup", c.setup, {{"given", Setup::kGiven}, {"active", Setup::kActive}},
                 "where the middle of the play comes from");
  if (const auto given = setup.Is({"given"})) {
    f("play_center_rad", c.play_center_rad, "motor angle / N - output angle there");
  }
  if (const auto active = setup.Is({"active"})) {
    f.Word("chamber_pushes", c.chamber_direction, {{"up", 1.0}, {"down", -1.0}}, "the output");
    f("setup_pressure_bar", c.setup_pressure_bar, kPositive, "asked for");
    f("min_pressure_bar", c.min_pressure_bar, kPositive, "contact counts only above it");
    f("setup_velocity_rad_s", c.velocity_rad_s, kPositive, "of the motor at the output");
    f("setup_torque_limit_Nm", c.motor_torque_limit_Nm, kPositive, "motor shaft");
    f("setup_travel_rad", c.travel_rad, kPositive, "given up after it");
    f("contact_travel_rad", c.contact_travel_rad, kPositive, "rigid motion that proves contact");
    f("setup_timeout_s", c.timeout_s, kPositive, "for pressure, and again for contact");
  }
  f.Check("backlash_rad", [&] { static_cast<void>(RegimeDetector(c)); });
}

void Describe(config::Fields& f, RegimeConfig& c) {
  f.Need("joints", c.joints, {1, types::kMaxJoints}, "in the order of joint_state");
}

bool RegimeConfig::requests_motion() const {
  return std::any_of(joints.begin(), joints.end(),
                     [](const DetectorConfig& joint) { return joint.setup == Setup::kActive; });
}

RegimeConfig LoadRegime(const std::filesystem::path& path) {
  return config::Read<RegimeConfig>(config::Section::Load(path, kSchema));
}

}  // namespace sinew::regime

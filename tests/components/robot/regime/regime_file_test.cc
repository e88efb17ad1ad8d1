#include "components/robot/regime/file/regime_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/doc_table.h"

namespace sinew::regime {
namespace {

using ::testing::HasSubstr;

RegimeConfig Parse(const std::string& text) {
  return ReadRegime(
      config::Section::Parse("schema: sinew-regime/1\n" + text, "regime.yaml", "sinew-regime/1"));
}

std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(Parse(text));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(RegimeFile, ReadsAGivenAndAnActiveSetup) {
  const RegimeConfig given = Parse(
      "joints: [{gear_ratio: 100, backlash_rad: 0.0464258, setup: given, play_center_rad: "
      "0.01}]\n");
  EXPECT_EQ(given.joints[0].play_center_rad, 0.01);
  EXPECT_FALSE(given.requests_motion());
  const RegimeConfig active = Parse(
      "joints: [{gear_ratio: 100, backlash_rad: 0.0464258, setup: active, chamber_pushes: down, "
      "setup_pressure_bar: 5}]\n");
  EXPECT_EQ(active.joints[0].chamber_direction, -1.0);
  EXPECT_TRUE(active.requests_motion());
}

TEST(RegimeFile, ReportsAnErrorInOneLine) {
  const struct {
    const char* text;
    const char* says;
  } kCases[] = {
      {"joints: []\n", "expected 1 to 12"},
      {"joints: [{backlash_rad: 0.04, setup: given}]\n", "gear_ratio"},
      {"joints: [{gear_ratio: 100, backlash_deg: 2.66, setup: given}]\n", "backlash_rad"},
      {"joints: [{gear_ratio: 100, backlash_rad: 0.04}]\n", "setup"},
      {"joints: [{gear_ratio: 100, backlash_rad: 0.04, setup: guess}]\n", "active"},
      {"joints: [{gear_ratio: 100, backlash_rad: 0.001, setup: given}]\n", "encoder noise"},
      {"joints: [{gear_ratio: 100, backlash_rad: .nan, setup: given}]\n", "backlash_rad"},
      {"joints: [{gear_ratio: 100, backlash_rad: 0.04, setup: given, setup_pressure_bar: 4}]\n",
       "setup_pressure_bar"},
  };
  for (const auto& c : kCases) {
    const std::string error = ErrorOf(c.text);
    EXPECT_THAT(error, HasSubstr(c.says)) << c.text;
    EXPECT_THAT(error, HasSubstr("regime.yaml:")) << c.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(RegimeFile, TheDocumentListsTheDefaults) {
  const std::map<std::string, std::string> listed = test::DefaultsIn("docs/participants/regime.md");
  const DetectorConfig c;
  const std::map<std::string, double> defaults = {
      {"encoder_counts_per_turn", 2.0 * M_PI / c.play.output_count_rad},
      {"encoder_noise_rad", c.play.output_noise_rad},
      {"hysteresis_counts", c.play.hysteresis_counts},
      {"sampling_skew_s", c.play.sampling_skew_s},
      {"inconsistent_rad", c.inconsistent_rad},
      {"play_center_rad", c.play_center_rad},
      {"setup_pressure_bar", c.setup_pressure_bar},
      {"min_pressure_bar", c.min_pressure_bar},
      {"setup_velocity_rad_s", c.velocity_rad_s},
      {"setup_torque_limit_Nm", c.motor_torque_limit_Nm},
      {"setup_travel_rad", c.travel_rad},
      {"contact_travel_rad", c.contact_travel_rad},
      {"setup_timeout_s", c.timeout_s}};
  for (const auto& [key, value] : defaults) {
    ASSERT_EQ(listed.count(key), 1u) << key;
    EXPECT_NEAR(std::stod(listed.at(key)), value, 1e-12 * std::abs(value)) << key;
  }
}

}  // namespace
}  // namespace sinew::regime

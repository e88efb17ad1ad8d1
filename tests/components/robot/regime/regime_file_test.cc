#include "components/robot/regime/file/regime_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::regime {
namespace {

using ::testing::HasSubstr;

RegimeConfig Parse(const std::string& text) {
  return config::Read<RegimeConfig>(
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

}  // namespace
}  // namespace sinew::regime

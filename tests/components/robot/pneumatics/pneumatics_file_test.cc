#include "components/robot/pneumatics/file/pneumatics_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::pneumatics {
namespace {

using ::testing::HasSubstr;

PneumaticsConfig Parse(const std::string& text) {
  return config::Read<PneumaticsConfig>(config::Section::Parse(
      "schema: sinew-pneumatics/1\n" + text, "pneumatics.yaml", "sinew-pneumatics/1"));
}

std::string ErrorOf(const std::string& text) {
  try {
    static_cast<void>(Parse(text));
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(PneumaticsFile, ReadsAPressureAndAStiffness) {
  const PneumaticsConfig pressure = Parse(R"(hold_disarmed: true
joints:
  - target_bar: 4
    hold_with: chamber
    compressor: {min_on_s: 0.3}
)");
  EXPECT_EQ(pressure.joints[0].target_bar, 4.0);
  EXPECT_EQ(pressure.joints[0].hold_with, HoldWith::kChamber);
  EXPECT_EQ(pressure.joints[0].compressor.min_on_s, 0.3);
  EXPECT_TRUE(pressure.hold_disarmed);
  const PneumaticsConfig stiffness = Parse(
      "joints: [{target_stiffness_Nm_rad: 30, stiffness: {pressure_bar: [2, 4], stiffness_Nm_rad: "
      "[10, 50]}}]\n");
  EXPECT_EQ(stiffness.joints[0].target_bar, 3.0);
}

TEST(PneumaticsFile, ReportsAnErrorInOneLine) {
  const struct {
    const char* text;
    const char* says;
  } kCases[] = {
      {"joints: []\n", "expected 1 to 12"},
      {"joints: [{target_Pa: 4}]\n", "target_bar"},
      {"joints: [{target_bar: .nan}]\n", "target_bar"},
      {"joints: [{target_bar: 6.5}]\n", "target is 6.5"},
      {"joints: [{hold_with: hope}]\n", "hold_with"},
      {"joints: [{valve: {min_on_ms: 3}}]\n", "min_on_s"},
      {"joints: [{target_stiffness_Nm_rad: 30}]\n", "stiffness"},
      {"joints: [{target_bar: 1, target_stiffness_Nm_rad: 30}]\n", "only one"},
      {"joints: [{stiffness: {pressure_bar: [2, 1], stiffness_Nm_rad: [1, 2]}}]\n", "rise"},
      {"joints: [{band_bar: 0.05, start_band_bar: 0.2}]\n", "correction"},
  };
  for (const auto& c : kCases) {
    const std::string error = ErrorOf(c.text);
    EXPECT_THAT(error, HasSubstr(c.says)) << c.text;
    EXPECT_THAT(error, HasSubstr("pneumatics.yaml:")) << c.text;
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

}  // namespace
}  // namespace sinew::pneumatics

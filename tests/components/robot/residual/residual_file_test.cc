#include "components/robot/residual/file/residual_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::residual {
namespace {

using ::testing::HasSubstr;

const std::string kRigFolder = SINEW_SOURCE_DIR "/robots/rig/";

ResidualConfig Parse(const std::string& text) {
  return config::Read<ResidualConfig>(config::Section::Parse(
      "schema: sinew-residual/1\n" + text, kRigFolder + "given.yaml", "sinew-residual/1"));
}

TEST(ResidualFile, TheShippedOneHasTheDefaults) {
  const ResidualConfig config = LoadResidual(kRigFolder + "residual.yaml");
  ASSERT_EQ(config.robot.joints.size(), 1u);
  EXPECT_EQ(config.robot.name, "rig_surrogate");
  const MonitorConfig expected;
  EXPECT_EQ(config.monitor.window_s, expected.window_s);
  EXPECT_EQ(config.monitor.block_s, expected.block_s);
  EXPECT_EQ(config.monitor.learn_s, expected.learn_s);
  EXPECT_EQ(config.monitor.watch_s, expected.watch_s);
  EXPECT_EQ(config.monitor.false_alarm_h, expected.false_alarm_h);
  EXPECT_EQ(config.monitor.slack_share, expected.slack_share);
  EXPECT_EQ(config.monitor.slack_Nm, expected.slack_Nm);
  EXPECT_EQ(config.monitor.drift_1_h, expected.drift_1_h);
  EXPECT_EQ(config.monitor.rest_velocity_rad_s, expected.rest_velocity_rad_s);
  EXPECT_EQ(config.monitor.reversal_guard_s, expected.reversal_guard_s);
  EXPECT_EQ(config.monitor.settle_distance_rad, expected.settle_distance_rad);
  EXPECT_EQ(config.monitor.not_excited_after_s, expected.not_excited_after_s);
}

TEST(ResidualFile, AnotherModelTakesThePlaceOfTheFilesOwn) {
  const ResidualConfig config =
      LoadResidual(kRigFolder + "residual.yaml", kRigFolder + "surrogate_model_identified.yaml");
  EXPECT_EQ(config.robot.name, "rig_surrogate_identified");
}

TEST(ResidualFile, ReportsAnErrorInOneLine) {
  const struct {
    const char* text;
    const char* says;
  } kCases[] = {
      {"learn_s: 30\n", "model"},
      {"model: no_such.yaml\n", "no_such.yaml"},
      {"model: surrogate_model.yaml\nblock_ms: 125\n", "block_ms"},
      {"model: surrogate_model.yaml\nlearn_s: .nan\n", "learn_s"},
      {"model: surrogate_model.yaml\nlearn_s: 2\n", "learn_s = 2"},
      {"model: surrogate_model.yaml\nwatch_s: 0.2\n", "watch_s = 0.2"},
      {"model: surrogate_model.yaml\nslack_share: 2\n", "slack_share"},
  };
  for (const auto& c : kCases) {
    try {
      static_cast<void>(Parse(c.text));
      ADD_FAILURE() << c.text;
    } catch (const UsageError& error) {
      EXPECT_THAT(error.what(), HasSubstr(c.says)) << c.text;
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace sinew::residual

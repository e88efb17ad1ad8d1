#include "components/model/identify/file/processing_file.h"

#include <gtest/gtest.h>

namespace sinew::identify {
namespace {

config::Section Parse(const std::string& blocks) {
  return config::Section::Parse("schema: sinew-model/1\n" + blocks, "model.yaml", "sinew-model/1");
}

std::string ErrorOf(const std::string& blocks) {
  try {
    const config::Section root = Parse(blocks);
    ReadProcessing(root, types::JointKind::kRevolute);
    ReadAsPublished(root);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(ProcessingFile, ReadsWhatIsThereAndLeavesTheRestToTheData) {
  const ProcessingOptions options =
      ReadProcessing(Parse("processing: {state_cutoff_Hz: 20, rest_velocity_rad_s: 0.04, "
                           "settle_distance_rad: 0.01}\n"),
                     types::JointKind::kRevolute);
  EXPECT_DOUBLE_EQ(options.state_cutoff_Hz, 20.0);
  EXPECT_DOUBLE_EQ(options.rest_velocity, 0.04);
  EXPECT_DOUBLE_EQ(options.settle_distance, 0.01);
  EXPECT_DOUBLE_EQ(options.parallel_cutoff_Hz, 0.0);
  EXPECT_DOUBLE_EQ(ReadProcessing(Parse("name: x\n"), types::JointKind::kPrismatic).state_cutoff_Hz,
                   0.0);
}

TEST(ProcessingFile, ReadsThePublishedProcessing) {
  const auto options = ReadAsPublished(
      Parse("as_published: {filter_order: 4, cutoff_Hz: 100, border_samples: 50, decimate: 10, "
            "added_effects: [stribeck]}\n"));
  ASSERT_TRUE(options.has_value());
  EXPECT_EQ(options->border_samples, 50);
  EXPECT_EQ(options->added_effects, std::vector<std::string>{"stribeck"});
  EXPECT_FALSE(ReadAsPublished(Parse("name: x\n")).has_value());
}

TEST(ProcessingFile, BadKeysAndValuesAreReportedWithLineAndKey) {
  const std::string unit = ErrorOf("processing:\n  rest_velocity_m_s: 0.1\n");
  EXPECT_NE(unit.find("model.yaml:3"), std::string::npos) << unit;
  EXPECT_NE(unit.find("rest_velocity"), std::string::npos) << unit;
  EXPECT_NE(ErrorOf("processing:\n  cutoff: 0.1\n").find("cutoff"), std::string::npos);
  EXPECT_NE(ErrorOf("processing: {state_cutoff_Hz: -3}\n"), "");
  EXPECT_NE(ErrorOf("processing: {state_cutoff_Hz: 5, parallel_cutoff_Hz: 10}\n"), "");
  EXPECT_NE(ErrorOf("as_published: {filter_order: 4, cutoff_Hz: 100, added_effects: [magic]}\n")
                .find("magic"),
            std::string::npos);
}

}  // namespace
}  // namespace sinew::identify

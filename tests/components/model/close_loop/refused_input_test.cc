// Recordings, maps and models that close-loop refuses, and recordings that it cannot assess.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/components/model/close_loop/example_options.h"
#include "tests/support/temporary_folder.h"

namespace sinew::close_loop {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

const fs::path kSource = SINEW_SOURCE_DIR;

TEST(CloseLoop, TooLittleDataIsAVerdictWithAReport) {
  const testing::TemporaryFolder folder;
  for (const bool training : {true, false}) {
    Options options = ExampleOptions("one_effect");
    const fs::path out = folder.path() / (training ? "training" : "held_out");
    std::vector<fs::path>& part = training ? options.train : options.held_out;
    part = {part.front().string() + "@10:13"};
    const Result result = CloseLoop(options);
    Write(result, out);
    EXPECT_FALSE(result.assessed);
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(out / "report.json"));
    EXPECT_EQ(json["verdict"], "too_little_data");
    EXPECT_EQ(json["too_little_data"]["rule"], training ? "blocks" : "held_out_blocks");
    EXPECT_TRUE(json["effects"].empty());
    EXPECT_TRUE(fs::exists(out / "report.html"));
    EXPECT_FALSE(fs::exists(out / "model.yaml"));  // nothing was fitted
    EXPECT_THAT(report::FormatHtml(result.page), HasSubstr("Too little data"));
    EXPECT_EQ(result.model.robot.joints[0].history.size(), 0u);
  }
}

// One line with the reason in it.
void ExpectRefused(const Options& options, const std::vector<std::string>& words) {
  try {
    CloseLoop(options);
    FAIL() << "was not refused";
  } catch (const UsageError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    for (const std::string& word : words) EXPECT_THAT(text, HasSubstr(word));
  }
}

// A changed copy of a text file.
fs::path Changed(const testing::TemporaryFolder& folder, const fs::path& file,
                 const std::string& from, const std::string& to) {
  std::ifstream in(file);
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  text.replace(at, from.size(), to);
  const fs::path out = folder.path() / file.filename();
  std::ofstream(out) << text;
  return out;
}

TEST(CloseLoopBadInput, AnUnknownKeyOfTheModelIsNamed) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  fs::copy(kSource / "robots" / "rig" / "rig.urdf", folder.path() / "rig.urdf");
  options.model =
      Changed(folder, kSource / "robots" / "rig" / "model.yaml", "link_length_m", "link_lenght_m");
  ExpectRefused(options, {"model.yaml:", "link_lenght_m"});
}

TEST(CloseLoopBadInput, AWrongUnitOfTheMapIsNamed) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  options.map = Changed(folder, options.map, "column: motor_current_A, unit: A",
                        "column: motor_current_A, unit: V");
  ExpectRefused(options, {"csv_map.yaml:", "unit"});
}

TEST(CloseLoopBadInput, ANotANumberCellIsNamedWithItsLine) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  options.train = {Changed(folder, options.train[0], "5.771986", "nan")};
  ExpectRefused(options, {"train_1.csv:3", "motor_angle_rad"});
}

TEST(CloseLoopBadInput, AMissingColumnIsNamed) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  options.train = {Changed(folder, options.train[0], "load_force_N", "load_N")};
  ExpectRefused(options, {"train_1.csv", "load_force_N"});
}

TEST(CloseLoopBadInput, ASignalTheModelNeedsIsNamed) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  options.map = Changed(folder, options.map,
                        "  motor_current: {column: motor_current_A, unit: A, sign: 1}\n", "");
  ExpectRefused(options, {"train_1.csv", "motor_current"});
}

TEST(CloseLoopBadInput, ABrokenRecordingIsRefused) {
  const testing::TemporaryFolder folder;
  Options options = ExampleOptions("clean");
  std::ofstream(folder.path() / "broken.mcap") << "this is no recording";
  options.train = {folder.path() / "broken.mcap"};
  ExpectRefused(options, {"broken.mcap"});
}

TEST(CloseLoopBadInput, TheHeldOutRecordingMayNotBeTrainedOn) {
  Options options = ExampleOptions("clean");
  options.held_out = {options.train[1]};
  ExpectRefused(options, {"train_2.csv", "held-out"});
}

TEST(CloseLoopBadInput, AJointTheModelLacksIsRefused) {
  Options options = ExampleOptions("clean");
  options.joint = 3;
  ExpectRefused(options, {"--joint 3"});
}

}  // namespace
}  // namespace sinew::close_loop

// `sinew check-data` as a program: lines, verdict, files, exit codes; and close-loop in front of
// which the same gate stands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using sinew::testing::Finished;
using ::testing::AllOf;
using ::testing::HasSubstr;

const fs::path kSource = SINEW_SOURCE_DIR;
const fs::path kClean = kSource / "tests" / "data" / "rig_examples" / "clean";

std::string Read(const fs::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// The recording with the current of row 900 and of every 600th after it thrown far out.
fs::path WithSpikes(const fs::path& folder, int count) {
  std::istringstream in(Read(kClean / "train_1.csv"));
  const fs::path path = folder / "spiked.csv";
  std::ofstream out(path);
  int row = -1;
  for (std::string line; std::getline(in, line); ++row) {
    if (row >= 900 && row < 900 + 600 * count && row % 600 == 300) {
      std::size_t comma = 0;
      for (int k = 0; k < 5; ++k) comma = line.find(',', comma) + 1;
      line.replace(comma, line.find(',', comma) - comma, "40.0");
    }
    out << line << '\n';
  }
  return path;
}

TEST(CheckData, ASoundRecordingIsOk) {
  const Finished run =
      testing::Run({kSinew, "check-data", "--model", (kClean / "rig.json").string(),
                    (kClean / "train_1.csv").string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("verdict: ok\n"));
  EXPECT_THAT(run.output, HasSubstr("finding rate: sampled at"));
}

TEST(CheckData, TheRowOfASpikeIsAFinding) {
  const testing::TemporaryFolder folder;
  const Finished run =
      testing::Run({kSinew, "check-data", "--model", (kClean / "rig.json").string(),
                    WithSpikes(folder.path(), 1).string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("finding left_out_rows: row 900 of motor_current in spiked.csv "
                                    "stands alone: left out\n"));
  EXPECT_THAT(run.output, HasSubstr("verdict: ok\n"));
}

TEST(CheckData, AFaultIsALineWithRowAndRemedyAndAPageWithPictures) {
  const testing::TemporaryFolder folder;
  const fs::path spiked = WithSpikes(folder.path(), 10);
  const fs::path out = folder.path() / "out";
  const Finished run =
      testing::Run({kSinew, "check-data", "--model", (kClean / "rig.json").string(),
                    spiked.string(), "--out", out.string()});
  EXPECT_EQ(run.exit_code, 1) << run.error;
  EXPECT_THAT(run.output, HasSubstr("fault spike: motor_current of spiked.csv, row "));
  EXPECT_THAT(run.output, HasSubstr("--accept-fault spike"));
  EXPECT_THAT(run.output, HasSubstr("verdict: data_fault\n"));
  const auto json = nlohmann::json::parse(Read(out / "check.json"));
  EXPECT_EQ(json["schema"], "sinew-check-data/1");
  EXPECT_EQ(json["verdict"], "data_fault");
  ASSERT_EQ(json["faults"].size(), 1u) << json["faults"].dump(2);
  EXPECT_EQ(json["faults"][0]["rule"], "spike");
  EXPECT_EQ(json["faults"][0]["rows"][0].get<int>() % 600, 300);
  EXPECT_GT(json["faults"][0]["statistic"], json["faults"][0]["limit"]);
  EXPECT_THAT(Read(out / "check.html"),
              AllOf(HasSubstr("stands alone between"), HasSubstr("--accept-fault spike")));
}

TEST(CheckData, AnAcceptedFaultIsListedAndTheVerdictIsOk) {
  const testing::TemporaryFolder folder;
  const Finished run =
      testing::Run({kSinew, "check-data", "--model", (kClean / "rig.json").string(),
                    "--accept-fault", "spike", WithSpikes(folder.path(), 1).string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output,
              HasSubstr("fault spike (accepted): motor_current of spiked.csv, row 900 "));
  EXPECT_THAT(run.output, HasSubstr("verdict: ok\n"));
}

TEST(CheckData, AnUnknownFaultIsAUsageError) {
  const Finished run =
      testing::Run({kSinew, "check-data", "--model", (kClean / "rig.json").string(),
                    "--accept-fault", "spikes", (kClean / "train_1.csv").string()});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("spikes"));
}

TEST(CloseLoopGate, AFaultEndsWithTheVerdictDataFaultAndNothingIsTraced) {
  const testing::TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const Finished run =
      testing::Run({kSinew, "close-loop", "--model", (kClean / "rig.json").string(), "--train",
                    WithSpikes(folder.path(), 10).string(), "--held-out",
                    (kClean / "sealed.csv").string(), "--out", out.string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("spike: motor_current of spiked.csv"));
  EXPECT_THAT(run.output, HasSubstr("verdict: data_fault\n"));
  const auto json = nlohmann::json::parse(Read(out / "report.json"));
  EXPECT_EQ(json["schema"], "sinew-close-loop/3");
  EXPECT_EQ(json["verdict"], "data_fault");
  EXPECT_EQ(json["faults"].size(), 1u);
  EXPECT_TRUE(json["effects"].empty());
  EXPECT_TRUE(json["not_excited"].empty());
  EXPECT_TRUE(fs::exists(out / "report.html"));
  EXPECT_FALSE(fs::exists(out / "model.yaml"));
}

TEST(CloseLoopGate, TheRowOfASpikeIsLeftOutAndReported) {
  const testing::TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const Finished run = testing::Run(
      {kSinew, "close-loop", "--model", (kClean / "rig.json").string(), "--train",
       WithSpikes(folder.path(), 1).string(), (kClean / "train_2.csv").string(), "--held-out",
       (kClean / "sealed.csv").string(), "--effect", "none", "--out", out.string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  const std::string left_out = "row 900 of motor_current in spiked.csv stands alone: left out";
  EXPECT_THAT(run.output, HasSubstr(left_out));
  const auto json = nlohmann::json::parse(Read(out / "report.json"));
  EXPECT_NE(json["verdict"], "data_fault");
  EXPECT_TRUE(json["faults"].empty());
  EXPECT_THAT(json["findings"].dump(), HasSubstr(left_out));
  EXPECT_EQ(json["recordings"]["train"][0]["rows"], 7164);
  EXPECT_TRUE(fs::exists(out / "model.yaml"));
}

TEST(CloseLoopGate, AnAcceptedFaultGoesOnAndIsListedInTheReport) {
  const testing::TemporaryFolder folder;
  const fs::path out = folder.path() / "out";
  const Finished run = testing::Run(
      {kSinew, "close-loop", "--model", (kClean / "rig.json").string(), "--train",
       WithSpikes(folder.path(), 1).string(), (kClean / "train_2.csv").string(), "--held-out",
       (kClean / "sealed.csv").string(), "--accept-fault", "spike", "--out", out.string()});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  const auto json = nlohmann::json::parse(Read(out / "report.json"));
  EXPECT_NE(json["verdict"], "data_fault");
  ASSERT_EQ(json["faults"].size(), 1u);
  EXPECT_EQ(json["faults"][0]["accepted"], true);
  EXPECT_TRUE(fs::exists(out / "model.yaml"));
}

}  // namespace
}  // namespace sinew

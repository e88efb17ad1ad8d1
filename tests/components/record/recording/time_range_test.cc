// Parts of recordings, given as FILE@START:END.
#include "components/record/recording/time_range.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "components/base/config/config.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/file/run_reader.h"

namespace sinew::recording {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using types::Signal;

types::Run Clock(Eigen::Index rows) {
  types::Run run;
  run.name = "a.csv";
  run.time_s = Eigen::VectorXd::LinSpaced(rows, 100.0, 100.0 + static_cast<double>(rows - 1));
  run.signals[Signal::kPosition] = run.time_s.array() * 2.0;
  return run;
}

std::string RangeError(const std::string& text) {
  try {
    ParseTimeRange(text);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(TimeRange, CutsOnTheRecordingsOwnClockAndLeavesTheEndToTheNext) {
  const types::Run run = Clock(10);
  const types::Run part = CutRun(run, ParseTimeRange("102:105.5"));
  EXPECT_EQ(part.time_s, Eigen::Vector4d(102.0, 103.0, 104.0, 105.0));
  EXPECT_EQ(part.At(Signal::kPosition)[0], 204.0);
  EXPECT_EQ(part.name, "a.csv@102:105.5");
  const types::Run before = CutRun(run, ParseTimeRange(":104"));
  const types::Run after = CutRun(run, ParseTimeRange("104:"));
  EXPECT_EQ(before.size() + after.size(), run.size());
  EXPECT_EQ(after.time_s[0], 104.0);
  EXPECT_NE(before.content_hash, after.content_hash);
  EXPECT_EQ(CutRun(run, ParseTimeRange(":")).size(), 10);
  EXPECT_EQ(CutRun(run, ParseTimeRange("-1e3:1e3")).size(), 10);
}

TEST(TimeRange, NamesTheRecordingItsClockAndTheRange) {
  try {
    CutRun(Clock(10), ParseTimeRange("0:60"));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "a.csv: no row in the range '0:60' (s), the recording's clock goes from 100 to 109 "
        "s");
  }
  EXPECT_EQ(
      RangeError("60:10"),
      "range '60:10': it ends before it begins, expected START:END in seconds, such as 10:60, "
      ":60 or 10:");
  for (const char* bad : {"10", "", "a:b", "1:2:3", "nan:", "1 :2", "inf:", "5:5", "0x1:"}) {
    EXPECT_THAT(RangeError(bad), HasSubstr("expected START:END")) << bad;
  }
}

TEST(TimeRange, RangesThatOnlyTouchDoNotOverlap) {
  const auto overlap = [](const char* a, const char* b) {
    return ParseTimeRange(a).Overlaps(ParseTimeRange(b));
  };
  EXPECT_FALSE(overlap(":30", "30:"));
  EXPECT_FALSE(overlap("30:", ":30"));
  EXPECT_TRUE(overlap("0:31", "30:"));
  EXPECT_TRUE(overlap(":", "5:6"));
}

TEST(TimeRange, NeverCrashesOnRandomText) {
  std::mt19937_64 random(3);
  const std::string alphabet = "0123456789:.-+e@ n";
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    const auto size = random() % 12;
    for (std::uint64_t i = 0; i < size; ++i) text += alphabet[random() % alphabet.size()];
    (void)RangeError(text);
  }
}

class RecordingPathTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) /
              ("recording_path_" +
               std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  static std::string ErrorOf(const fs::path& path, const fs::path& map) {
    try {
      ReadRuns(path, map);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(RecordingPathTest, ReadsAPartOfAFileAndSaysWhatIsWrongWithIt) {
  const fs::path map = Write("map.yaml",
                             "schema: sinew-csv-map/1\nkind: rotary\ntime: {column: t, unit: s}\n"
                             "signals:\n  position: {column: q, unit: rad}\n");
  const std::string csv = Write("a.csv", "t,q\n0,5\n1,6\n2,7\n3,8\n");
  const types::Run part = ReadRuns(csv + "@1:3", map).at(0);
  EXPECT_EQ(part.At(Signal::kPosition), Eigen::Vector2d(6.0, 7.0));
  EXPECT_EQ(part.name, csv + "@1:3");
  EXPECT_EQ(ErrorOf(csv + "@10:60", map),
            csv + ": no row in the range '10:60' (s), the recording's clock goes from 0 to 3 s");
  EXPECT_EQ(ErrorOf(csv + "@10", map),
            csv + ": range '10': no ':', expected START:END in seconds, such as 10:60, :60 or 10:");
  EXPECT_THAT(ErrorOf(folder_ / "none.csv@1:2", map), HasSubstr("none.csv"));
  EXPECT_THAT(ErrorOf(folder_ / "none@home.csv", map), HasSubstr("none@home.csv"));
}

TEST_F(RecordingPathTest, AFileOfThatVeryNameWins) {
  const fs::path odd = Write("a@1:2", "x");
  EXPECT_FALSE(ParseRecordingPath(odd).range.has_value());
  EXPECT_EQ(ParseRecordingPath(odd).file, odd);
  const RecordingPath mcap = ParseRecordingPath("runs@lab/day.mcap@:5");
  EXPECT_TRUE(mcap.IsMcap());
  EXPECT_EQ(mcap.file, "runs@lab/day.mcap");
  EXPECT_EQ(mcap.range->end_s, 5.0);
  EXPECT_FALSE(ParseRecordingPath("runs@1:2/day.csv").range.has_value());
}

}  // namespace
}  // namespace sinew::recording

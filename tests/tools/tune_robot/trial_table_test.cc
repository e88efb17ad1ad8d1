#include "tools/tune_robot/trial_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::tune {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

const TableHead kTableHead{.trials = 3, .seed = 7, .inputs = {{"world", "0123456789abcdef"}}};

GainTrial KeptTrial(int stage, int number, std::optional<double> fell_at_s = std::nullopt) {
  GainTrial trial{.stage = stage, .number = number, .name = stage == 0 ? "published" : ""};
  trial.pid.proportional_Nm_rad = 100.0 / 3.0;
  trial.pid.integral_Nm_rad_s = 0.1;
  trial.pid.derivative_Nm_s_rad = 5.0;
  ClosedLoopScore score;
  score.mse_rad2 = 1.0 / 7.0;
  score.worst_rad = 0.2;
  score.torque_change_rms_Nm = 1e-4;
  score.faulted = fell_at_s.has_value();
  score.fell_at_s = fell_at_s;
  trial.score = score;
  return trial;
}

std::string ErrorOf(const std::filesystem::path& path, const TableHead& head) {
  try {
    const TrialTable table(path, head);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(TrialTable, GivesBackWhatWasAppendedToTheBit) {
  const sinew::testing::TemporaryFolder folder;
  const auto path = folder.path() / "trials.jsonl";
  {
    TrialTable table(path, kTableHead);
    EXPECT_TRUE(table.known().empty());
    table.Append(KeptTrial(0, 0));
    table.Append(KeptTrial(1, 2, 1.5916666666666666));
  }
  const TrialTable again(path, kTableHead);
  ASSERT_EQ(again.known().size(), 2u);
  EXPECT_EQ(again.known()[0].name, "published");
  EXPECT_EQ(again.known()[0].pid.proportional_Nm_rad, 100.0 / 3.0);
  EXPECT_EQ(again.known()[0].score->mse_rad2, 1.0 / 7.0);
  EXPECT_FALSE(again.known()[0].score->fell_at_s.has_value());
  EXPECT_EQ(again.known()[1].score->fell_at_s, 1.5916666666666666);
  EXPECT_TRUE(again.known()[1].score->faulted);
}

TEST(TrialTable, ALineThatWasCutIsTakenAwayWhereverItWasCut) {
  const sinew::testing::TemporaryFolder folder;
  const auto path = folder.path() / "trials.jsonl";
  {
    TrialTable table(path, kTableHead);
    table.Append(KeptTrial(1, 0));
    table.Append(KeptTrial(1, 1));
  }
  const std::string whole = config::ReadFile(path);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    std::ofstream(path, std::ios::binary) << whole.substr(0, size);
    const std::string left = whole.substr(0, size);
    const auto lines = static_cast<std::size_t>(std::count(left.begin(), left.end(), '\n'));
    {
      TrialTable table(path, kTableHead);
      ASSERT_EQ(table.known().size(), lines == 0 ? 0 : lines - 1) << "cut at " << size;
      for (std::size_t i = table.known().size(); i < 2; ++i) {
        table.Append(KeptTrial(1, static_cast<int>(i)));
      }
    }
    ASSERT_EQ(config::ReadFile(path), whole) << "cut at " << size;
  }
}

TEST(TrialTable, FinishPutsTheTrialsInOrder) {
  const sinew::testing::TemporaryFolder folder;
  const auto path = folder.path() / "trials.jsonl";
  TrialTable table(path, kTableHead);
  table.Append(KeptTrial(1, 1));
  table.Append(KeptTrial(1, 0));
  table.Finish({KeptTrial(1, 0), KeptTrial(1, 1)});
  const TrialTable again(path, kTableHead);
  ASSERT_EQ(again.known().size(), 2u);
  EXPECT_EQ(again.known()[0].number, 0);
}

TEST(TrialTable, SaysWhatIsAnotherSearchs) {
  const sinew::testing::TemporaryFolder folder;
  const auto path = folder.path() / "trials.jsonl";
  { const TrialTable table(path, kTableHead); }
  TableHead other = kTableHead;
  other.seed = 8;
  EXPECT_THAT(ErrorOf(path, other), StartsWith(path.string() + ":1: "));
  EXPECT_THAT(ErrorOf(path, other), HasSubstr("'seed' is 7, expected 8"));
  other = kTableHead;
  other.inputs["world"] = "fedcba9876543210";
  EXPECT_THAT(ErrorOf(path, other), HasSubstr("'world' has changed"));
  EXPECT_EQ(ErrorOf(path, kTableHead), "");
}

TEST(TrialTable, NamesFileAndLineOfWhatIsNoTrial) {
  const sinew::testing::TemporaryFolder folder;
  const auto path = folder.path() / "trials.jsonl";
  { const TrialTable table(path, kTableHead); }
  std::ofstream(path, std::ios::app) << "{\"stage\": 1}\n";
  EXPECT_THAT(ErrorOf(path, kTableHead), StartsWith(path.string() + ":2: "));
  std::ofstream(path, std::ios::trunc) << "time_s,angle\n";
  EXPECT_THAT(ErrorOf(path, kTableHead), StartsWith(path.string() + ":1: "));
  EXPECT_THAT(ErrorOf(folder.path() / "absent" / "trials.jsonl", kTableHead),
              HasSubstr("cannot be written"));
}

TEST(TrialTable, TheHashIsFnv1a) {
  const sinew::testing::TemporaryFolder folder;
  // Test vectors of the algorithm's authors (draft-eastlake-fnv): "", "a", "foobar".
  EXPECT_EQ(HashOfFile(folder.Write("empty", "")), "cbf29ce484222325");
  EXPECT_EQ(HashOfFile(folder.Write("a", "a")), "af63dc4c8601ec8c");
  EXPECT_EQ(HashOfFile(folder.Write("foobar", "foobar")), "85944171f73967e8");
}

}  // namespace
}  // namespace sinew::tune

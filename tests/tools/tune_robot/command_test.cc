// `sinew tune pid` as a program: killed and started again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using sinew::testing::Finished;
using sinew::testing::Program;
using sinew::testing::TemporaryFolder;
using ::testing::HasSubstr;

const std::string kTuneFiles = SINEW_SOURCE_DIR "/robots/biped/";

std::string FileText(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

// The shipped search over the first second: the soft gains fall, the others stand.
std::string ShortSearch(const TemporaryFolder& folder) {
  std::string text = FileText(kTuneFiles + "tune_pid.yaml");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  for (const std::string key : {"world", "reference", "control", "performance"}) {
    replace(key + ": ", key + ": " + kTuneFiles);
  }
  replace("duration_s: 15", "duration_s: 1");
  return folder.Write("search.yaml", text);
}

std::vector<std::string> TunePidArguments(const std::string& search,
                                          const std::filesystem::path& out, int threads) {
  return {kSinew,  "tune",  "pid",        search,      "--trials",
          "20",    "--out", out.string(), "--threads", std::to_string(threads),
          "--json"};
}

TEST(TuneCommand, KilledAndStartedAgainItEndsWithTheSameTable) {
  const TemporaryFolder folder;
  const std::string search = ShortSearch(folder);
  const auto whole = folder.path() / "whole", resumed = folder.path() / "resumed";
  const Finished once = testing::Run(TunePidArguments(search, whole, 2), 120s);
  ASSERT_EQ(once.exit_code, 0) << once.error;
  {
    // Prints the table as it grows; a table that is there is watched without delay.
    const std::string begun = folder.Write("resumed/trials.jsonl", "");
    Program killed(TunePidArguments(search, resumed, 1));
    Program table({"tail", "-n", "+1", "-F", begun});
    ASSERT_TRUE(table.WaitForText("{\"stage\":1,", 60s)) << killed.error();
    killed.Signal(SIGKILL);
    EXPECT_EQ(killed.Wait(10s), -SIGKILL);
  }
  const std::string left = FileText(resumed / "trials.jsonl");
  EXPECT_LT(left.size(), FileText(whole / "trials.jsonl").size());
  EXPECT_FALSE(std::filesystem::exists(resumed / "control.yaml"));
  const Finished again = testing::Run(TunePidArguments(search, resumed, 2), 120s);
  ASSERT_EQ(again.exit_code, 0) << again.error;
  EXPECT_EQ(FileText(resumed / "trials.jsonl"), FileText(whole / "trials.jsonl"));
  EXPECT_EQ(again.output, once.output);
  const nlohmann::json result = nlohmann::json::parse(again.output);
  EXPECT_EQ(result.at("trials"), 2 + 2 * 20);
  EXPECT_GT(result.at("fell"), 0);
  EXPECT_GT(result.at("best").at("proportional_Nm_rad"), 60.0);
  for (const char* file : {"control.yaml", "section.json", "tune-pid-1.svg", "tune-pid-2.svg"}) {
    EXPECT_TRUE(std::filesystem::exists(resumed / file)) << file;
  }
  // A finished search has nothing left to run, and another one is refused.
  std::vector<std::string> other = TunePidArguments(search, resumed, 2);
  other.insert(other.end(), {"--seed", "2"});
  const Finished refused = testing::Run(other);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.error, HasSubstr("trials.jsonl:1: another search: 'seed' is 1, expected 2"));
}

TEST(TuneCommand, ASearchFileThatIsNoneIsAUsageErrorInOneLine) {
  const TemporaryFolder folder;
  const std::string file = folder.Write("search.yaml", "schema: sinew-tune/1\nworld: none.yaml\n");
  for (const char* what : {"pid", "pressure"}) {
    const Finished run = testing::Run({kSinew, "tune", what, file});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.error, HasSubstr(file));
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << run.error;
  }
}

}  // namespace
}  // namespace sinew

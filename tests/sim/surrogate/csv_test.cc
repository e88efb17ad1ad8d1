#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew::testing {
namespace {

const std::string kProgram = std::string(SINEW_BIN_DIR) + "/sinew-surrogate-csv";

std::string Text(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(SurrogateCsv, OneSeedWritesTheSameFileTwice) {
  const TemporaryFolder folder;
  const std::string a = folder.path() / "a.csv", b = folder.path() / "b.csv";
  EXPECT_EQ(testing::Run({kProgram, "--out", a, "--seconds", "5", "--seed", "7"}).exit_code, 0);
  EXPECT_EQ(testing::Run({kProgram, "--out", b, "--seconds", "5", "--seed", "7"}).exit_code, 0);
  EXPECT_GT(Text(a).size(), 10000u);
  EXPECT_EQ(Text(a), Text(b));
}

TEST(SurrogateCsv, EffectsChangeTheFileAndAreListed) {
  const TemporaryFolder folder;
  const std::string a = folder.path() / "a.csv", b = folder.path() / "b.csv";
  testing::Run({kProgram, "--out", a, "--seconds", "20"});
  testing::Run({kProgram, "--out", b, "--seconds", "20", "--effect", "stribeck=0.3"});
  EXPECT_NE(Text(a), Text(b));
  EXPECT_NE(testing::Run({kProgram, "--list-effects"}).output.find("seal_hysteresis"),
            std::string::npos);
}

TEST(SurrogateCsv, BadInputEndsWithTwoAndWritesNothing) {
  const TemporaryFolder folder;
  const std::string out = folder.path() / "a.csv";
  const std::string config =
      folder.Write("bad.yaml", "schema: sinew-surrogate/1\ngear: {ratio: 100}\n");
  for (const auto& arguments : std::vector<std::vector<std::string>>{
           {kProgram, "--out", out, "--effect", "wobble"},
           {kProgram, "--out", out, "--excitation", "shake"},
           {kProgram, "--out", out, "--seconds", "nan"},
           {kProgram, "--out", out, "--config", config},
           {kProgram, "--out", out, "--config", folder.path() / "absent.yaml"},
           {kProgram}}) {
    const Finished finished = testing::Run(arguments);
    EXPECT_EQ(finished.exit_code, 2) << finished.error;
    EXPECT_FALSE(finished.error.empty());
    EXPECT_FALSE(std::filesystem::exists(out));
  }
}

}  // namespace
}  // namespace sinew::testing

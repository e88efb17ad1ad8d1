// What every subcommand of `sinew` owes a user: help with examples, one-line errors, exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"

namespace sinew {
namespace {

using sinew::testing::Finished;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// As the program's own help lists them.
std::vector<std::string> Subcommands() {
  std::vector<std::string> names;
  std::istringstream help(testing::Run({kSinew, "--help"}).output);
  bool listing = false;
  for (std::string line; std::getline(help, line);) {
    if (line.rfind("Commands to ", 0) == 0) {
      listing = true;
    } else if (line.empty()) {
      listing = false;
    } else if (listing && line.size() > 2 && line[2] != ' ') {
      names.push_back(line.substr(2, line.find(' ', 2) - 2));
    }
  }
  return names;
}

TEST(SinewCommand, EveryCommandExplainsItselfWithAnExample) {
  const std::vector<std::string> names = Subcommands();
  ASSERT_GE(names.size(), 6u);
  for (const std::string& name : names) {
    const Finished run = testing::Run({kSinew, name, "--help"});
    EXPECT_EQ(run.exit_code, 0) << name;
    if (name != "version") {
      EXPECT_THAT(run.output, HasSubstr("  sinew " + name + " ")) << name;
    }
    EXPECT_THAT(run.output, HasSubstr("Usage: ")) << name;
  }
}

TEST(SinewCommand, AnUnknownOptionIsAUsageErrorInOneLine) {
  for (const std::string& name : Subcommands()) {
    const Finished run = testing::Run({kSinew, name, "--no-such-option"});
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1) << name << run.error;
    EXPECT_THAT(run.error, StartsWith("sinew")) << name;
    EXPECT_EQ(run.output, "") << name;
  }
}

TEST(SinewCommand, AnUnknownCommandIsAUsageError) {
  const Finished run = testing::Run({kSinew, "fly"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("fly"));
}

TEST(SinewCommand, EveryCommandIsInOneOfTheFiveGroups) {
  const std::string help = testing::Run({kSinew, "--help"}).output;
  std::size_t groups = 0;
  for (std::size_t at = 0; (at = help.find("\nCommands to ", at)) != std::string::npos; ++at)
    ++groups;
  EXPECT_GE(groups, 4u) << help;  // without reproduction
  EXPECT_LE(groups, 5u) << help;
  EXPECT_THAT(help,
              ::testing::ContainsRegex("\nOther commands:\n(  (help|version|completion) [^\n]*"
                                       "\n){3}\n"))
      << "one that stands in no group: tools/sinew/guide.cc";
}

TEST(SinewCommand, HelpIsThatOfTheCommand) {
  EXPECT_EQ(testing::Run({kSinew, "help", "model", "show"}).output,
            testing::Run({kSinew, "model", "show", "--help"}).output);
  EXPECT_EQ(testing::Run({kSinew, "help"}).output, testing::Run({kSinew, "--help"}).output);
}

TEST(SinewCommand, AMistypedWordIsAnsweredWithTheNearest) {
  const struct {
    std::vector<std::string> line;
    const char* meant;
  } kCases[] = {{{"lst"}, "; did you mean 'list'?"},
                {{"lanuch", "file.yaml"}, "; did you mean 'launch'?"},
                {{"list", "--domian", "3"}, "; did you mean '--domain'?"},
                {{"model", "shwo"}, "; did you mean 'show'?"},
                {{"help", "clos-loop"}, "; did you mean 'close-loop'?"}};
  for (const auto& mistyped : kCases) {
    std::vector<std::string> line = {kSinew};
    line.insert(line.end(), mistyped.line.begin(), mistyped.line.end());
    const Finished run = testing::Run(line);
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_THAT(run.error, HasSubstr(mistyped.meant));
  }
  EXPECT_EQ(testing::Run({kSinew, "fly"}).error.find("did you mean"), std::string::npos);
}

TEST(SinewCommand, NoCommandShowsTheHelpAsAnError) {
  const Finished run = testing::Run({kSinew});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("launch"));
}

TEST(SinewCommand, VersionAsJson) {
  const Finished run = testing::Run({kSinew, "version", "--json"});
  ASSERT_EQ(run.exit_code, 0);
  const nlohmann::json version = nlohmann::json::parse(run.output);
  EXPECT_EQ(version["topics_hash"].get<std::string>().size(), 8u);
}

TEST(SinewCommand, ADomainOutOfRangeIsAUsageError) {
  const Finished run = testing::Run({kSinew, "arm", "--domain", "233"});
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("232"));
}

}  // namespace
}  // namespace sinew

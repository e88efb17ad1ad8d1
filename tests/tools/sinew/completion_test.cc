// The completion scripts, run by the shells themselves.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using sinew::testing::Finished;
using sinew::testing::TemporaryFolder;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsSupersetOf;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::UnorderedElementsAre;

std::vector<std::string> Lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// What bash offers for the words typed so far; the last one may be empty.
std::vector<std::string> Offered(const std::vector<std::string>& typed,
                                 const std::string& folder = "/") {
  std::string words = "sinew";
  for (const std::string& word : typed) words += " '" + word + "'";
  const std::string script = "cd '" + folder + "'; compopt() { :; }; source <('" + kSinew +
                             "' completion bash); COMP_WORDS=(" + words +
                             "); COMP_CWORD=" + std::to_string(typed.size()) +
                             "; _sinew; printf '%s\\n' \"${COMPREPLY[@]}\"";
  const Finished run = testing::Run({"bash", "-uo", "pipefail", "-c", script});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  std::vector<std::string> lines = Lines(run.output);
  lines.erase(std::remove(lines.begin(), lines.end(), ""), lines.end());
  return lines;
}

TEST(BashCompletion, OffersTheCommands) {
  EXPECT_THAT(Offered({""}), IsSupersetOf({"launch", "arm", "estop", "completion", "version"}));
}

TEST(BashCompletion, OffersWhatBeginsAsTyped) {
  EXPECT_THAT(Offered({"la"}), ElementsAre("launch"));
}

TEST(BashCompletion, OffersTheOptionsOfTheCommandThatIsTyped) {
  const auto offered = Offered({"launch", "--"});
  EXPECT_THAT(offered, IsSupersetOf({"--set", "--record", "--dry-run", "--help"}));
  EXPECT_THAT(offered, AllOf(Each(StartsWith("--")), Not(Contains("--reason"))));
  EXPECT_THAT(Offered({"arm", "--"}), Contains("--reason"));
  EXPECT_THAT(Offered({"plot", "--"}), IsSupersetOf({"--from", "--to", "--png", "--svg"}));
  EXPECT_THAT(Offered({"echo", "--"}), IsSupersetOf({"--once", "--rate"}));
  EXPECT_THAT(Offered({"log", "--level", ""}), IsSupersetOf({"warn", "error"}));
}

TEST(BashCompletion, OffersSubcommandsOfSubcommands) {
  EXPECT_THAT(Offered({"completion", ""}), IsSupersetOf({"bash", "zsh"}));
}

TEST(BashCompletion, OffersTheAllowedWordsOfAnOption) {
  EXPECT_THAT(Offered({"launch", "--mode", ""}), UnorderedElementsAre("realtime", "lockstep"));
  EXPECT_THAT(Offered({"launch", "--mode", "=", "lo"}), ElementsAre("lockstep"));
}

TEST(BashCompletion, OffersFilesWhereAFileBelongs) {
  const TemporaryFolder folder;
  folder.Write("deploy_rig.yaml", "");
  EXPECT_THAT(Offered({"launch", "dep"}, folder.path()), ElementsAre("deploy_rig.yaml"));
  EXPECT_THAT(Offered({"launch", "--record", "dep"}, folder.path()),
              ElementsAre("deploy_rig.yaml"));
  EXPECT_THAT(Offered({"plot", "dep"}, folder.path()), ElementsAre("deploy_rig.yaml"));
  EXPECT_THAT(Offered({"launch", "--seed", "dep"}, folder.path()), ElementsAre());
  EXPECT_THAT(Offered({"close-loop", "--train", "dep"}, folder.path()),
              ElementsAre("deploy_rig.yaml"));
}

TEST(ZshCompletion, TheScriptIsValidAndDefinesEachCommand) {
  SKIP_WITHOUT_PACKAGE(testing::Run({"zsh", "--version"}).exit_code == 0, "zsh");
  const Finished script = testing::Run({kSinew, "completion", "zsh"});
  ASSERT_EQ(script.exit_code, 0);
  EXPECT_THAT(script.output, StartsWith("#compdef sinew\n"));
  const Finished run = testing::Run(
      {"zsh", "-f", "-c",
       "autoload -U compinit && compinit -D -u && source <('" + kSinew +
           "' completion zsh) && print $_comps[sinew] && functions -m '_sinew*' | grep '()'"});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("_sinew\n"));
  EXPECT_THAT(run.output, HasSubstr("_sinew_launch ()"));
  EXPECT_THAT(run.output, HasSubstr("_sinew_completion_zsh ()"));
  EXPECT_EQ(run.error, "");
}

}  // namespace
}  // namespace sinew

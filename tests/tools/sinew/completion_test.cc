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
  std::string words = "'" + kSinew + "'";
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
  EXPECT_THAT(Offered({"completion", ""}), UnorderedElementsAre("bash", "zsh", "fish"));
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

TEST(BashCompletion, OffersTopicsAndTheirFields) {
  EXPECT_THAT(Offered({"hz", "joint_"}), IsSupersetOf({"joint_state", "joint_command"}));
  EXPECT_THAT(Offered({"echo", "joint_"}), IsSupersetOf({"joint_state", "joint_command"}));
  EXPECT_THAT(Offered({"echo", "joint_state.pos"}),
              IsSupersetOf({"joint_state.position_rad", "joint_state.position_rad[0]"}));
  EXPECT_THAT(Offered({"plot", "run.mcap", "joint_state.header.t"}),
              ElementsAre("joint_state.header.tick"));
  EXPECT_THAT(Offered({"echo", "joint_state", "--field", "header.ti"}), ElementsAre("header.tick"));
  EXPECT_THAT(Offered({"record", "--topics", "reference,joint_s"}),
              ElementsAre("reference,joint_state"));
}

TEST(BashCompletion, OffersEffects) {
  EXPECT_THAT(Offered({"effects", "strib"}), ElementsAre("stribeck"));
  EXPECT_THAT(Offered({"close-loop", "--without-effect", "strib"}), ElementsAre("stribeck"));
}

TEST(BashCompletion, OffersTheProcessesOfTheDeploymentThatIsTyped) {
  const TemporaryFolder folder;
  folder.Write("two.yaml",
               "schema: sinew-deployment/1\nprocesses:\n  - {name: rig, program: a}\n"
               "  - {name: control, program: b}\n  - {name: $(touch x), program: c}\n");
  const auto offered = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = {"launch", "two.yaml"};
    all.insert(all.end(), words.begin(), words.end());
    return Offered(all, folder.path());
  };
  EXPECT_THAT(offered({"--without", ""}), UnorderedElementsAre("rig", "control"));
  EXPECT_THAT(offered({"--compose", "rig,co"}), ElementsAre("rig,control"));
  EXPECT_THAT(offered({"--arg", "r"}), ElementsAre("rig="));
  EXPECT_THAT(offered({"--set", ""}), IsSupersetOf({"mode=", "rig.config=", "control.restart="}));
  EXPECT_THAT(offered({"--set", "rig.config", "=", "tw"}), ElementsAre("two.yaml"));
  EXPECT_THAT(Offered({"launch", "none.yaml", "--without", ""}, folder.path()), ElementsAre());
}

TEST(BashCompletion, OffersTheCommandsThatHelpKnows) {
  EXPECT_THAT(Offered({"help", "laun"}), ElementsAre("launch"));
  EXPECT_THAT(Offered({"help", "model", "sh"}), ElementsAre("show"));
}

TEST(ZshCompletion, TheScriptOffersWordsWithDescriptionsAndFiles) {
  SKIP_WITHOUT_PACKAGE(testing::Run({"zsh", "--version"}).exit_code == 0, "zsh");
  const Finished run = testing::Run(
      {"zsh", "-f", "-c",
       "autoload -U compinit && compinit -D -u && source <('" + kSinew +
           "' completion zsh) && print $_comps[sinew]\n"
           "_describe() { print -l -- \"${(@P)3}\" }\n"
           "compadd() { print -l -- \"${(@P)4}\" }\ncompset() { : }\n_files() { print files }\n"
           "words=('" +
           kSinew + "' la) CURRENT=2; _sinew\nwords=('" + kSinew +
           "' plot joint_) CURRENT=3; _sinew"});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(Lines(run.output),
              IsSupersetOf({"_sinew", "launch:Start the processes of a deployment file",
                            "joint_state.", "joint_command.", "files"}));
  EXPECT_EQ(run.error, "");
}

TEST(FishCompletion, OffersCommandsAndFields) {
  SKIP_WITHOUT_PACKAGE(testing::Run({"fish", "--version"}).exit_code == 0, "fish");
  const Finished run =
      testing::Run({"fish", "--no-config", "-c",
                    "set PATH '" + std::string(SINEW_BIN_DIR) +
                        "' $PATH; sinew completion fish | source; complete -C 'sinew la'; "
                        "complete -C 'sinew effects strib'; complete -C 'sinew launch --mode l'"});
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(Lines(run.output), ElementsAre("launch\tStart the processes of a deployment file",
                                             "stribeck", "lockstep"));
}

}  // namespace
}  // namespace sinew

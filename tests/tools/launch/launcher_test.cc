// `sinew launch` with tiny shell programs: no DDS, every wait bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using sinew::testing::Finished;
using sinew::testing::Program;
using sinew::testing::TemporaryFolder;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr auto kLimit = 20s;  // for what takes well under a second on an idle machine
// Waits without a child process of its own, and ends by SIGINT, SIGTERM or after a minute.
const std::string kWaits = "exec sleep 60";

class LauncherTest : public ::testing::Test {
 protected:
  // A shell script as a process; `more` holds further keys, "key: value, ".
  void Add(const std::string& name, const std::string& script, const std::string& more = "") {
    const std::string file = folder_.Write(name + ".sh", script + "\n");
    processes_ += "  - {name: " + name + ", program: sh, plain: true, " + more + "arguments: [" +
                  file + "]}\n";
  }
  std::string Deployment(const std::string& keys = "") const {
    return folder_.Write("deploy.yaml", "schema: sinew-deployment/1\nname: try\n" + keys +
                                            "processes:\n" + processes_);
  }
  Finished Launch(const std::string& keys = "", const std::vector<std::string>& options = {}) {
    std::vector<std::string> words = {kSinew, "launch", Deployment(keys)};
    words.insert(words.end(), options.begin(), options.end());
    return testing::Run(words, kLimit);
  }
  std::string Path(const std::string& name) const { return (folder_.path() / name).string(); }
  pid_t PidIn(const std::string& name) const {
    std::ifstream file(Path(name));
    pid_t pid = 0;
    file >> pid;
    return pid;
  }

  TemporaryFolder folder_;
  std::string processes_;
};

TEST_F(LauncherTest, LinesArePrefixedAndStreamsKeptApart) {
  Add("one", "echo first");
  Add("second", "echo other >&2");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_EQ(run.output, "one    | first\n") << "no colours in a pipe";
  EXPECT_THAT(run.error, HasSubstr("second | other\n"));
}

TEST_F(LauncherTest, AFailureIsReportedWithCauseAndLastLines) {
  Add("good", kWaits);
  Add("bad", "echo fine; echo 'cannot open /dev/robot' >&2; exit 3");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, ContainsRegex("bad: exit code 3 after [0-9.]+ s; its last lines:\n"
                                       "    cannot open /dev/robot"));
  EXPECT_THAT(run.error, Not(HasSubstr("good:")));
}

TEST_F(LauncherTest, ASignalThatKilledAProcessIsNamed) {
  Add("bad", "kill -SEGV $$");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("signal 11 (Segmentation fault)"));
}

TEST_F(LauncherTest, AFailedProcessIsRestartedUntilItWorks) {
  Add("flaky", "echo x >> " + Path("tries") + "; [ $(wc -l < " + Path("tries") + ") -ge 3 ]",
      "restart: on_failure, back_off_s: 0.01, ");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("restart 2 of 3"));
  EXPECT_THAT(run.error, HasSubstr("2 restarts"));
}

TEST_F(LauncherTest, RestartsEndAtTheirMaximum) {
  Add("bad", "echo x >> " + Path("tries") + "; exit 4",
      "restart: on_failure, max_restarts: 2, back_off_s: 0.01, ");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_EQ(std::filesystem::file_size(Path("tries")), 3 * 2u) << "three starts, two bytes each";
  EXPECT_THAT(run.error, HasSubstr("exit code 4"));
  EXPECT_THAT(run.error, HasSubstr("restarted 2 times before"));
}

TEST_F(LauncherTest, AnObserverThatFailsDoesNotStopTheOthers) {
  Add("watcher", "echo x >> " + Path("tries") + "; exit 5",
      "vital: false, max_restarts: 1, back_off_s: 0.01, ");
  Add("worker", "while ! [ -e " + Path("tries") + " ] || [ $(wc -l < " + Path("tries") +
                    ") -lt 2 ]; do sleep 0.02; done; sleep 0.3; echo done");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 1) << "the failure is not forgotten";
  EXPECT_THAT(run.output, HasSubstr("worker  | done"));
  EXPECT_THAT(run.error, HasSubstr("watcher failed: exit code 5"));
  EXPECT_THAT(run.error, HasSubstr("the others go on"));
  EXPECT_THAT(run.error, HasSubstr("restart 1 of 1"));
}

TEST_F(LauncherTest, WhenTheLauncherIsKilledItsProcessesEndInOrder) {
  Add("plant", "trap 'echo motors off > " + Path("off") + "; exit 0' TERM; echo $$ > " +
                   Path("plant.pid") + "; echo up; while :; do sleep 0.05; done");
  Program launch({kSinew, "launch", Deployment()});
  ASSERT_TRUE(launch.WaitForText("up", kLimit));
  launch.Signal(SIGKILL);
  (void)launch.Wait(kLimit);
  ASSERT_GT(PidIn("plant.pid"), 1);
  EXPECT_TRUE(testing::WaitUntilGone(PidIn("plant.pid"), kLimit));
  EXPECT_TRUE(std::filesystem::exists(Path("off"))) << "it was killed";
}

// As a program with capabilities does (setcap): it loses the signal of its parent's death. Domain
// 115.
TEST_F(LauncherTest, WhenTheLauncherIsKilledAProgramWithoutTheKernelsSignalEndsToo) {
  Add("plant", "echo $$ > " + Path("plant.pid") + "; exec setpriv --pdeathsig clear " +
                   SINEW_BIN_DIR "/sinew-surrogate --domain 115 --config " SINEW_SOURCE_DIR
                                 "/robots/rig/surrogate.yaml");
  Program launch({kSinew, "launch", Deployment()});
  ASSERT_TRUE(launch.WaitForText("domain 115", kLimit)) << launch.error();
  launch.Signal(SIGKILL);
  (void)launch.Wait(kLimit);
  const pid_t plant = PidIn("plant.pid");
  ASSERT_GT(plant, 1);
  const bool gone = testing::WaitUntilGone(plant, kLimit);
  EXPECT_TRUE(gone);
  if (!gone) ::kill(plant, SIGKILL);
}

TEST_F(LauncherTest, SuccessIsNotRestartedOnFailureOnly) {
  Add("good", "echo x >> " + Path("tries"), "restart: on_failure, ");
  EXPECT_EQ(Launch().exit_code, 0);
  EXPECT_EQ(std::filesystem::file_size(Path("tries")), 2u);
}

TEST_F(LauncherTest, AlwaysRestartsAfterSuccessToo) {
  Add("short", "echo x >> " + Path("tries"),
      "restart: always, max_restarts: 2, back_off_s: 0.01, ");
  EXPECT_EQ(Launch().exit_code, 0);
  EXPECT_EQ(std::filesystem::file_size(Path("tries")), 3 * 2u);
}

TEST_F(LauncherTest, CtrlCStopsAllAndLeavesNothing) {
  Add("a", "echo $$ > " + Path("a.pid") + "; echo up; " + kWaits);
  Add("b", "sleep 60 & echo $! > " + Path("b.pid") + "; echo up2; wait");
  Program launch({kSinew, "launch", Deployment()});
  ASSERT_TRUE(launch.WaitForText("up\n", kLimit) && launch.WaitForText("up2", kLimit));
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 0) << launch.error();
  EXPECT_THAT(launch.error(), HasSubstr("stopped as asked"));
  for (const char* name : {"a.pid", "b.pid"}) {
    ASSERT_GT(PidIn(name), 1);
    EXPECT_TRUE(testing::WaitUntilGone(PidIn(name), kLimit)) << name;
  }
}

TEST_F(LauncherTest, ProviderStopsFirstAndThoseThatStopLastLast) {
  // Each says when it has ended; the builtin wait returns at once when the trap fires.
  const auto script = [](const std::string& name) {
    return "trap 'echo end of " + name + "; exit 0' INT; echo up " + name +
           "; while :; do sleep 60 & wait; done";
  };
  Add("keeper", script("keeper"), "stop_last: true, ");
  Add("worker", script("worker"));
  Add("plant", script("plant"));
  Program launch({kSinew, "launch", Deployment("provider: plant\n")});
  for (const char* name : {"up keeper", "up worker", "up plant"}) {
    ASSERT_TRUE(launch.WaitForText(name, kLimit)) << name;
  }
  launch.Signal(SIGTERM);
  EXPECT_EQ(launch.Wait(kLimit), 0) << launch.error();
  const std::string text = launch.output();
  EXPECT_LT(text.find("end of plant"), text.find("end of worker"));
  EXPECT_LT(text.find("end of worker"), text.find("end of keeper"));
  EXPECT_NE(text.find("end of keeper"), std::string::npos);
}

TEST_F(LauncherTest, WhoIgnoresSigintAndSigtermIsKilledAndNamed) {
  Add("deaf",
      "trap '' INT TERM; echo $$ > " + Path("pid") + "; echo up; while :; do sleep 60; done");
  Program launch({kSinew, "launch", Deployment("grace_s: 0.1\n")});
  ASSERT_TRUE(launch.WaitForText("up", kLimit));
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 1);
  EXPECT_THAT(launch.error(), HasSubstr("deaf does not stop: SIGTERM"));
  EXPECT_THAT(launch.error(), HasSubstr("deaf does not stop: SIGKILL"));
  EXPECT_TRUE(testing::WaitUntilGone(PidIn("pid"), kLimit));
}

TEST_F(LauncherTest, AThirdCtrlCKillsAtOnce) {
  Add("deaf", "trap '' INT TERM; echo up; while :; do sleep 60; done");
  Program launch({kSinew, "launch", Deployment("grace_s: 600\n")});
  ASSERT_TRUE(launch.WaitForText("up", kLimit));
  launch.Signal(SIGINT);
  ASSERT_TRUE(launch.WaitForText("stopping", kLimit));
  // Equal signals may merge while one is pending, so ask until it has ended.
  int exit_code = Program::kTimeout;
  for (int i = 0; i < 100 && exit_code == Program::kTimeout; ++i) {
    launch.Signal(SIGINT);
    exit_code = launch.Wait(100ms);
  }
  EXPECT_EQ(exit_code, 1);
}

TEST_F(LauncherTest, TheSessionEndsWithItsProvider) {
  Add("plant", "echo going; exit 0");
  Add("worker", "echo $$ > " + Path("pid") + "; " + kWaits);
  const Finished run = Launch("provider: plant\ngrace_s: 0.2\n");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, HasSubstr("session ended: plant is done"));
  EXPECT_TRUE(testing::WaitUntilGone(PidIn("pid"), kLimit));
}

TEST_F(LauncherTest, WhoEndsByItselfAfterTheSessionIsNotSignalled) {
  Add("plant", "exit 0", "after: [worker], ");
  Add("worker", "trap 'echo hit; exit 1' INT; echo up; sleep 0.3; echo whole");
  const Finished run = Launch("provider: plant\ngrace_s: 10\n");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.output, HasSubstr("whole"));
  EXPECT_THAT(run.output, Not(HasSubstr("hit")));
}

TEST_F(LauncherTest, AProcessStartsAfterThoseItWaitsForAreReady) {
  Add("late", "cat " + Path("made"), "after: [early], ");
  Add("early", "echo starting; echo content > " + Path("made") + "; echo ready now; " + kWaits,
      "ready_when: ready now, ");
  Program launch({kSinew, "launch", Deployment("")});
  EXPECT_TRUE(launch.WaitForText("late  | content", kLimit)) << launch.error();
  launch.Signal(SIGINT);
  EXPECT_EQ(launch.Wait(kLimit), 0);
}

TEST_F(LauncherTest, AKilledLauncherLeavesNoOrphan) {
  Add("a", "echo $$ > " + Path("a.pid") + "; echo up; " + kWaits);
  Program launch({kSinew, "launch", Deployment()});
  ASSERT_TRUE(launch.WaitForText("up", kLimit));
  launch.Signal(SIGKILL);
  EXPECT_EQ(launch.Wait(kLimit), -SIGKILL);
  EXPECT_TRUE(testing::WaitUntilGone(PidIn("a.pid"), kLimit));
}

TEST_F(LauncherTest, ForeignProcessesAreLeftAlone) {
  Program foreign({"sleep", "60"});
  Add("bad", "exit 1");
  EXPECT_EQ(Launch().exit_code, 1);
  EXPECT_TRUE(testing::IsRunning(foreign.pid()));
}

TEST_F(LauncherTest, WhatAProcessLeavesBehindEndsWithIt) {
  Add("parent", "sleep 60 & echo $! > " + Path("pid") + "; exit 0");
  EXPECT_EQ(Launch().exit_code, 0);
  EXPECT_TRUE(testing::WaitUntilGone(PidIn("pid"), kLimit));
}

TEST_F(LauncherTest, ALotOfOutputArrivesWhole) {
  Add("loud", "seq 1 20000");
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 0);
  std::istringstream lines(run.output);
  int count = 0;
  for (std::string line; std::getline(lines, line);) {
    ++count;
    ASSERT_EQ(line, "loud | " + std::to_string(count));
  }
  EXPECT_EQ(count, 20000);
}

TEST_F(LauncherTest, StopsWhenNobodyReadsItsOutput) {
  Add("loud", "while echo line; do :; done");
  const Finished run = testing::Run({"bash", "-c",
                                     kSinew + " launch " + Deployment("grace_s: 0.2\n") +
                                         " | head -n 1; echo code ${PIPESTATUS[0]}"},
                                    kLimit);
  EXPECT_THAT(run.output, HasSubstr("loud | line"));
  EXPECT_THAT(run.error, HasSubstr("the output is closed"));
}

TEST_F(LauncherTest, TheReportAsJsonIsAllOfTheStandardOutput) {
  Add("bad", "echo text; echo why >&2; exit 7");
  const Finished run = Launch("", {"--json"});
  EXPECT_EQ(run.exit_code, 1);
  const nlohmann::json report = nlohmann::json::parse(run.output);
  EXPECT_FALSE(report["ok"]);
  EXPECT_EQ(report["failures"][0]["process"], "bad");
  EXPECT_THAT(report["failures"][0]["cause"].get<std::string>(), HasSubstr("exit code 7"));
  EXPECT_EQ(report["failures"][0]["last_lines"][0], "why");
}

TEST_F(LauncherTest, ADryRunStartsNothing) {
  Add("toucher", "echo x > " + Path("touched"));
  const Finished run = Launch("", {"--dry-run"});
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, HasSubstr("toucher: "));
  EXPECT_FALSE(std::filesystem::exists(Path("touched")));
}

TEST_F(LauncherTest, TheDomainOfTheEnvironmentWinsOverTheFileAndTheOptionOverBoth) {
  Add("any", "true");
  const std::string file = Deployment("domain_id: 7\n");
  const auto domain = [&file](const std::vector<std::string>& before,
                              const std::vector<std::string>& after) {
    std::vector<std::string> words = {"env", "-u", "SINEW_DOMAIN"};
    words.insert(words.end(), before.begin(), before.end());
    words.insert(words.end(), {kSinew, "launch", file, "--dry-run", "--json"});
    words.insert(words.end(), after.begin(), after.end());
    return nlohmann::json::parse(testing::Run(words, kLimit).output)["domain_id"].get<int>();
  };
  EXPECT_EQ(domain({}, {}), 7);
  EXPECT_EQ(domain({"SINEW_DOMAIN=8"}, {}), 8);
  EXPECT_EQ(domain({"SINEW_DOMAIN=8"}, {"--domain", "9"}), 9);
}

TEST_F(LauncherTest, AMissingProgramIsAUsageErrorBeforeAnythingStarts) {
  Add("toucher", "echo x > " + Path("touched"));
  processes_ += "  - {name: gone, program: no-such-program}\n";
  const Finished run = Launch();
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.error, HasSubstr("no program 'no-such-program'"));
  EXPECT_EQ(std::count(run.error.begin(), run.error.end(), '\n'), 1);
  EXPECT_FALSE(std::filesystem::exists(Path("touched")));
}

}  // namespace
}  // namespace sinew

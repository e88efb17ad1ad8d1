// .ci/bare_root up to the command that it runs: needs no root, network or repository, because
// stand-ins come first in PATH.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::EndsWith;
using testing::Finished;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::Program;
using testing::TemporaryFolder;

class BareRoot : public ::testing::Test {
 protected:
  void SetUp() override {
    StandIn("id", "echo 0");
    StandIn("git", "exit 0");
    StandIn("unshare", "while [ \"$1\" != -- ]; do shift; done; shift; exec \"$@\"");
    fs::create_directory(folder_.path() / "tmp");
  }
  void StandIn(const std::string& name, const std::string& body) const {
    fs::permissions(folder_.Write("bin/" + name, "#!/bin/bash\n" + body + "\n"),
                    fs::perms::owner_all);
  }
  std::vector<std::string> Command(const std::vector<std::string>& arguments) const {
    std::vector<std::string> command = {
        "/usr/bin/env", "--default-signal=INT",
        "PATH=" + (folder_.path() / "bin").string() + ":/usr/bin:/bin",
        "TMPDIR=" + (folder_.path() / "tmp").string(), SINEW_SOURCE_DIR "/.ci/bare_root"};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return command;
  }
  std::vector<std::string> LeftBehind() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "tmp")) {
      names.push_back(entry.path());
    }
    return names;
  }
  TemporaryFolder folder_;
};

TEST_F(BareRoot, HelpNamesTheCommandsFormAndItsExitCode) {
  const Finished run = testing::Run(Command({"--help"}));
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.output, HasSubstr(".ci/bare_root COMMAND"));
  EXPECT_THAT(run.output, HasSubstr("125"));
  EXPECT_THAT(run.output, Not(HasSubstr("set -")));
}

TEST_F(BareRoot, WithoutACommandItSaysWhatIsMissing) {
  const Finished run = testing::Run(Command({}));
  EXPECT_EQ(run.exit_code, 125);
  EXPECT_EQ(run.error, "bare_root: no command; see .ci/bare_root --help\n");
}

TEST_F(BareRoot, AnUnknownOptionIsNamed) {
  const Finished run = testing::Run(Command({"--keep", "true"}));
  EXPECT_EQ(run.exit_code, 125);
  EXPECT_EQ(run.error, "bare_root: unknown option '--keep'; see .ci/bare_root --help\n");
}

TEST_F(BareRoot, OnlyRootMayMakeARoot) {
  StandIn("id", "echo 1000");
  const Finished run = testing::Run(Command({"true"}));
  EXPECT_EQ(run.exit_code, 125);
  EXPECT_EQ(run.error, "bare_root: must be run by root, to make a root of its own\n");
}

TEST_F(BareRoot, WhatDebootstrapSaidLastIsShownAndNothingIsLeft) {
  StandIn("debootstrap", "for k in 1 2 3 4 5 6; do echo line $k; done; exit 1");
  const Finished run = testing::Run(Command({"true"}));
  EXPECT_EQ(run.exit_code, 125);
  EXPECT_THAT(run.error, Not(HasSubstr("line 1\n")));
  EXPECT_THAT(run.error, EndsWith("line 2\nline 3\nline 4\nline 5\nline 6\n"
                                  "bare_root: debootstrap failed; its last lines stand above\n"));
  EXPECT_THAT(LeftBehind(), IsEmpty());
}

TEST_F(BareRoot, ASignalEndsWhatRunsAndNothingIsLeft) {
  const std::vector<std::pair<int, int>> signals = {{SIGINT, 130}, {SIGTERM, 143}};
  for (const auto& [signal, exit_code] : signals) {
    const fs::path started = folder_.path() / "started";
    fs::remove(started);
    // debootstrap --variant=minbase SUITE ROOT MIRROR
    StandIn("debootstrap", "mkdir -p \"$3/usr\"; echo $$ > '" + started.string() + ".new'; mv '" +
                               started.string() + ".new' '" + started.string() +
                               "'; exec sleep 600");
    Program run(Command({"true"}));
    for (int k = 0; k < 3000 && !fs::exists(started); ++k) run.WaitForText("never said", 10ms);
    ASSERT_TRUE(fs::exists(started)) << run.error();
    pid_t sleeper = 0;
    std::ifstream(started) >> sleeper;
    run.Signal(signal);
    EXPECT_EQ(run.Wait(20s), exit_code) << run.error();
    EXPECT_TRUE(testing::WaitUntilGone(sleeper, 20s));
    EXPECT_THAT(LeftBehind(), IsEmpty());
  }
}

}  // namespace
}  // namespace sinew

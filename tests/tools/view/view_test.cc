// sinew-view beside the rig's surrogate, asked by Foxglove's own client in node. Domains 220 to
// 222.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/program.h"
#include "tests/support/sinew_program.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"
#include "tests/tools/view/view_program.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

const std::string kViewRobots = SINEW_SOURCE_DIR "/robots/";

std::vector<std::string> SurrogateLine(const std::string& domain) {
  return {kViewBin + "sinew-surrogate", "--domain", domain, "--config",
          kViewRobots + "rig/surrogate.yaml"};
}

bool HasNode() { return Run({"node", "--version"}).exit_code == 0; }

TEST(ViewSystem, FoxglovesClientReceivesEveryJointStateOfTheRig) {
  SKIP_WITHOUT_PACKAGE(HasNode(), "nodejs");
  Program surrogate(SurrogateLine("220"));
  View view({"--domain", "220"});
  ASSERT_NE(view.port(), "") << view.log();
  const Finished client = view.Ask({"receive", "1200"});
  EXPECT_EQ(client.exit_code, 0) << client.error << view.log();
  ASSERT_TRUE(nlohmann::json::accept(client.output)) << client.output;
  EXPECT_EQ(nlohmann::json::parse(client.output)["missing"], 0);
  EXPECT_EQ(view.End(), 0) << view.log();
}

TEST(ViewSystem, ThePageCommandsWithItsTokenAndNobodyElseDoes) {
  SKIP_WITHOUT_PACKAGE(HasNode(), "nodejs");
  Program surrogate(SurrogateLine("221"));
  // Who is armed without a controller is in fault 60 ms later.
  Program reference({kViewBin + "sinew-reference", "--domain", "221", "--config",
                     kViewRobots + "rig/reference_benchmark.yaml"});
  Program control({kViewBin + "sinew-control", "--domain", "221", "--config",
                   kViewRobots + "rig/control_pid.yaml"});
  ASSERT_TRUE(control.WaitForText("control", kViewLimit)) << control.error();
  View allowed({"--domain", "221", "--allow-arming"});
  View observer(
      {"--domain", "221", "--name", "observer", "--config", kViewRobots + "rig/view.yaml"});
  ASSERT_NE(allowed.port(), "") << allowed.log();
  ASSERT_NE(observer.port(), "") << observer.log();
  const Finished operated = allowed.Ask({"operate"});
  EXPECT_EQ(operated.exit_code, 0) << operated.error << allowed.log();
  const Finished observed = observer.Ask({"observe"});
  EXPECT_EQ(observed.exit_code, 0) << observed.error << observer.log();
  EXPECT_EQ(allowed.End(), 0);
  EXPECT_EQ(observer.End(), 0);
}

TEST(ViewSystem, ARecordingOfThePageIsShownByTheSamePage) {
  SKIP_WITHOUT_PACKAGE(HasNode(), "nodejs");
  const TemporaryFolder folder;
  Program surrogate(SurrogateLine("222"));
  View live({"--domain", "222", "--record-folder", folder.path().string()});
  ASSERT_NE(live.port(), "") << live.log();
  const std::string note = (folder.path() / "note.json").string();
  const Finished recorded = live.Ask({"record", note});
  ASSERT_EQ(recorded.exit_code, 0) << recorded.error << live.log();
  EXPECT_EQ(live.End(), 0);
  std::ifstream in(note);
  const std::string file = nlohmann::json::parse(in)["file"];

  View shown({file});
  ASSERT_NE(shown.port(), "") << shown.log();
  const Finished asked = shown.Ask({"recorded"});
  EXPECT_EQ(asked.exit_code, 0) << asked.error << shown.log();
  EXPECT_EQ(shown.End(), 0);
}

TEST(ViewSystem, WhatIsWrongIsOneLine) {
  const TemporaryFolder folder;
  const std::string no_recording = (folder.path() / "none.mcap").string();
  std::ofstream(folder.path() / "text.mcap") << "no recording";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{no_recording}, "none.mcap"},
      {{(folder.path() / "text.mcap").string()}, "text.mcap"},
      {{"--address", "nowhere"}, "expected an IPv4 address of this host"},
      {{"--address", "0.0.0.0"}, "expected an IPv4 address of this host"},
      {{"--address", "192.0.2.1"}, "192.0.2.1:8765"},
      {{"--urdf", kViewRobots + "rig/model.yaml"}, "model.yaml"},
      {{"--config", kViewRobots + "rig/model.yaml"}, "sinew-view/1"},
      {{"--record-folder", "/nowhere"}, "/nowhere"},
  };
  for (const auto& [arguments, expected] : cases) {
    std::vector<std::string> line = {kViewBin + "sinew-view", "--domain", "222"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    const Finished run = sinew::testing::Run(line, kViewLimit);
    EXPECT_EQ(run.exit_code, 2) << expected << run.error;
    EXPECT_THAT(run.error, HasSubstr(expected));
  }
}

}  // namespace
}  // namespace sinew::testing

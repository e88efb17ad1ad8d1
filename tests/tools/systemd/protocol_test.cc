// Whole programs under something that speaks as systemd does: ready, fed, stopped in order.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>

#include "tests/support/notify_socket.h"
#include "tests/support/program.h"
#include "tests/support/temporary_folder.h"

namespace sinew {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::NotifySocket;
using testing::Program;
using testing::TemporaryFolder;

const std::string kBin = SINEW_BIN_DIR;
const std::string kRig = std::string(SINEW_SOURCE_DIR) + "/robots/rig";
constexpr auto kEnough = 30s;

TEST(SystemdProtocol, AParticipantIsReadyWhenConfiguredIsFedAndSaysThatItStops) {
  NotifySocket systemd(2s);
  Program reference(
      {kBin + "/sinew-reference", "--config", kRig + "/reference_watch.yaml", "--domain", "137"});
  EXPECT_TRUE(systemd.WaitFor("STATUS=configured: waiting for joint_state", kEnough));
  EXPECT_TRUE(systemd.WaitFor("READY=1", kEnough));
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
  reference.Signal(SIGTERM);
  EXPECT_TRUE(systemd.WaitFor("STOPPING=1", kEnough));
  EXPECT_EQ(reference.Wait(kEnough), 0);
}

TEST(SystemdProtocol, AStateProviderReportsWhetherTheRobotMayMove) {
  NotifySocket systemd(2s);
  Program provider({kBin + "/sinew-surrogate", "--config", kRig + "/surrogate.yaml", "--arm",
                    "--await-timeout", "1", "--domain", "138"});
  EXPECT_TRUE(systemd.WaitFor("STATUS=active: --arm waits: no joint_command answers", kEnough));
  EXPECT_TRUE(systemd.WaitFor("READY=1", kEnough));
  EXPECT_TRUE(systemd.WaitFor("STATUS=active: --arm: not armed: no joint_command", kEnough));
  const testing::Finished estop = testing::Run(
      {"/usr/bin/env", "-u", "NOTIFY_SOCKET", kBin + "/sinew", "estop", "--domain", "138"});
  EXPECT_EQ(estop.exit_code, 0) << estop.error;
  EXPECT_TRUE(systemd.WaitFor("STATUS=fault: estopped", kEnough));
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough)) << "a fault of the robot is no hanging loop";
  provider.Signal(SIGTERM);
  EXPECT_TRUE(systemd.WaitFor("STOPPING=1", kEnough));
  EXPECT_EQ(provider.Wait(kEnough), 0);
}

TEST(SystemdProtocol, ALoggerIsReadyWhenItRecords) {
  const TemporaryFolder folder;
  NotifySocket systemd(2s);
  Program logger({kBin + "/sinew-logger", "--keep-going", "--out",
                  (folder.path() / "run.mcap").string(), "--domain", "139"});
  EXPECT_TRUE(systemd.WaitFor("STATUS=active: recording run.mcap", kEnough));
  EXPECT_TRUE(systemd.WaitFor("READY=1", kEnough));
  EXPECT_TRUE(systemd.WaitFor("WATCHDOG=1", kEnough));
  logger.Signal(SIGTERM);
  EXPECT_TRUE(systemd.WaitFor("STOPPING=1", kEnough));
  EXPECT_EQ(logger.Wait(kEnough), 0);
}

TEST(SystemdProtocol, ABadConfigurationIsNeverReady) {
  const TemporaryFolder folder;
  NotifySocket systemd(2s);
  Program reference({kBin + "/sinew-reference", "--config",
                     folder.Write("reference.yaml", "schema: sinew-reference/1\n"), "--domain",
                     "137"});
  EXPECT_EQ(reference.Wait(kEnough), 2);
  EXPECT_THAT(systemd.Collect(0ms), Not(Contains(HasSubstr("READY=1"))));
}

}  // namespace
}  // namespace sinew

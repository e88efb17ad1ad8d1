// Limits, governors and disks, in folders that stand for /proc and /sys.
#include "tools/inspect/host_checks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "tests/support/temporary_folder.h"

namespace sinew::inspect {
namespace {

using ::testing::HasSubstr;

std::string Limits(const std::string& priority, const std::string& memory) {
  return "Limit                     Soft Limit           Hard Limit           Units     \n"
         "Max locked memory         " +
         memory + "              " + memory +
         "              bytes     \n"
         "Max nice priority         0                    0                    \n"
         "Max realtime priority     " +
         priority + "                    " + priority + "                    \n";
}

std::vector<Finding> Check(const std::string& limits, const std::string& capabilities) {
  const testing::TemporaryFolder root;
  root.Write("proc/self/limits", limits);
  root.Write("proc/self/status", "Name:\tx\nCapEff:\t" + capabilities + "\n");
  return CheckRealtimeLimits(root.path(), 80);
}

TEST(RealtimeLimits, AreEnoughOrAreWarnings) {
  const auto low = Check(Limits("0", "8388608"), "0000000000000000");
  ASSERT_EQ(low.size(), 2u);
  EXPECT_EQ(low[0].severity, Severity::kWarning);
  EXPECT_THAT(low[0].text, HasSubstr("up to priority 0, --realtime needs 80"));
  EXPECT_THAT(low[0].advice, HasSubstr("rtprio 80"));
  EXPECT_EQ(low[1].severity, Severity::kWarning);
  EXPECT_THAT(low[1].text, HasSubstr("8.4 MB"));
  const auto high = Check(Limits("80", "unlimited"), "0000000000000000");
  EXPECT_EQ(high[0].severity, Severity::kOk);
  EXPECT_EQ(high[1].severity, Severity::kOk);
  EXPECT_EQ(Check(Limits("79", "unlimited"), "0")[0].severity, Severity::kWarning);
}

TEST(RealtimeLimits, CapabilitiesStandAboveThem) {
  // CAP_SYS_NICE is bit 23, CAP_IPC_LOCK bit 14.
  const auto both = Check(Limits("0", "8388608"), "0000000000804000");
  EXPECT_EQ(both[0].severity, Severity::kOk);
  EXPECT_EQ(both[1].severity, Severity::kOk);
  const auto nice = Check(Limits("0", "8388608"), "0000000000800000");
  EXPECT_EQ(nice[0].severity, Severity::kOk);
  EXPECT_EQ(nice[1].severity, Severity::kWarning);
}

TEST(RealtimeLimits, AFileThatIsNotThereIsANote) {
  EXPECT_EQ(Check("", "0")[0].severity, Severity::kNote);
}

TEST(CpuGovernor, IsPerformanceOnEveryCpuOrAWarning) {
  const testing::TemporaryFolder root;
  EXPECT_EQ(CheckCpuGovernor(root.path()).severity, Severity::kNote);
  const std::string folder = "sys/devices/system/cpu/";
  root.Write(folder + "cpu0/cpufreq/scaling_governor", "performance\n");
  root.Write(folder + "cpu1/cpufreq/scaling_governor", "performance\n");
  root.Write(folder + "cpuidle/current_driver", "x\n");
  EXPECT_EQ(CheckCpuGovernor(root.path()).severity, Severity::kOk);
  root.Write(folder + "cpu1/cpufreq/scaling_governor", "powersave\n");
  const Finding finding = CheckCpuGovernor(root.path());
  EXPECT_EQ(finding.severity, Severity::kWarning);
  EXPECT_EQ(finding.text, "performance on 1, powersave on 1 CPUs");
}

TEST(DiskSpaceCheck, IsMeasuredInMinutesOfRecording) {
  const double rate = 1e6;
  EXPECT_EQ(CheckDiskSpace({"/r", 8'000'000'000, 9'000'000'000}, rate).severity, Severity::kOk);
  const Finding low = CheckDiskSpace({"/r", 3'600'000'000, 9'000'000'000}, rate);
  EXPECT_EQ(low.severity, Severity::kWarning);
  EXPECT_THAT(low.text, HasSubstr("/r: 3.6 GB free, 60 minutes"));
  EXPECT_EQ(CheckDiskSpace({"/r", 599'000'000, 9'000'000'000}, rate).severity, Severity::kFault);
  EXPECT_EQ(CheckDiskSpace({"/r", 0, 0}, rate).severity, Severity::kFault);
}

TEST(DiskSpaceCheck, ReadsAFolderAndRefusesAMissingOne) {
  const testing::TemporaryFolder root;
  const DiskSpace space = ReadDiskSpace(root.path());
  EXPECT_GT(space.total_bytes, 0u);
  EXPECT_LE(space.free_bytes, space.total_bytes);
  EXPECT_THROW((void)ReadDiskSpace(root.path() / "absent"), UsageError);
}

TEST(SharedMemorySpace, HoldsARobotInLockstepOrIsAFault) {
  EXPECT_EQ(CheckSharedMemorySpace({"/dev/shm", 64'000'000, 64'000'000}).severity, Severity::kOk);
  EXPECT_EQ(CheckSharedMemorySpace({"/dev/shm", 1'000'000, 64'000'000}).severity, Severity::kFault);
}

TEST(Findings, FaultsSetTheExitCodeAndWarningsOnlyWhenStrict) {
  const Finding ok{"a", Severity::kOk, "fine", ""}, warning{"b", Severity::kWarning, "so", "do"},
      fault{"c", Severity::kFault, "bad", "do"};
  EXPECT_EQ(ExitCode({ok}, true), 0);
  EXPECT_EQ(ExitCode({ok, warning}, false), 0);
  EXPECT_EQ(ExitCode({ok, warning}, true), 1);
  EXPECT_EQ(ExitCode({fault, ok}, false), 1);
  EXPECT_EQ(FormatFindings({{"longer", Severity::kOk, "fine", ""}, warning}),
            "ok       longer  fine\n"
            "warning  b       so\n"
            "                 -> do\n");
  EXPECT_EQ(FindingsJson({fault})[0]["severity"], "fault");
}

}  // namespace
}  // namespace sinew::inspect

// Oracle: the table of the README; statuses as the kernel encodes them (exit code << 8, signal).
#include "tools/launch/process_end.h"

#include <gtest/gtest.h>

#include <csignal>

namespace sinew::launch {
namespace {

constexpr int Exit(int code) { return code << 8; }

Process With(Restart restart) {
  Process process;
  process.restart = restart;
  process.max_restarts = 2;
  process.back_off_s = 0.5;
  return process;
}

TEST(ProcessEnd, ItsCauseIsTheExitCodeOrTheSignal) {
  EXPECT_EQ(CauseOf(Exit(3)), "exit code 3");
  EXPECT_EQ(CauseOf(SIGSEGV), "signal 11 (Segmentation fault)");
}

TEST(ProcessEnd, AStopSignalIsNoFailureOnlyWhenItWasSent) {
  for (const int status : {SIGINT, SIGTERM, Exit(130), Exit(143)}) {
    EXPECT_FALSE(Failed({.status = status, .deployment_stops = true, .asked_to_stop = true}))
        << status;
    EXPECT_TRUE(Failed({.status = status})) << status;
  }
  EXPECT_TRUE(Failed({.status = SIGKILL, .deployment_stops = true, .asked_to_stop = true}));
  EXPECT_TRUE(Failed({.status = Exit(1), .deployment_stops = true, .asked_to_stop = true}));
  EXPECT_FALSE(Failed({.status = 0}));
}

TEST(ProcessEnd, ThePolicySaysWhetherItStartsAgain) {
  EXPECT_FALSE(StartsAgain(With(Restart::kNever), {.status = Exit(1)}));
  EXPECT_TRUE(StartsAgain(With(Restart::kOnFailure), {.status = Exit(1)}));
  EXPECT_FALSE(StartsAgain(With(Restart::kOnFailure), {.status = 0}));
  EXPECT_TRUE(StartsAgain(With(Restart::kAlways), {.status = 0}));
}

TEST(ProcessEnd, AProviderThatIsDoneIsNotStartedAgainAFailedOneIs) {
  EXPECT_FALSE(StartsAgain(With(Restart::kAlways), {.status = 0, .is_provider = true}));
  EXPECT_TRUE(StartsAgain(With(Restart::kAlways), {.status = Exit(1), .is_provider = true}));
}

TEST(ProcessEnd, NothingStartsAgainWhileTheDeploymentStopsOrAfterTheLastRestart) {
  EXPECT_FALSE(StartsAgain(With(Restart::kAlways), {.status = Exit(1), .deployment_stops = true}));
  EXPECT_TRUE(StartsAgain(With(Restart::kAlways), {.status = Exit(1), .restarts = 1}));
  EXPECT_FALSE(StartsAgain(With(Restart::kAlways), {.status = Exit(1), .restarts = 2}));
}

TEST(ProcessEnd, TheBackOffDoublesUpToAMinute) {
  const Process process = With(Restart::kAlways);
  EXPECT_EQ(BackOff_s(process, 0), 0.5);
  EXPECT_EQ(BackOff_s(process, 1), 1.0);
  EXPECT_EQ(BackOff_s(process, 3), 4.0);
  EXPECT_EQ(BackOff_s(process, 10), 60.0);
  EXPECT_EQ(BackOff_s(process, 1000), 60.0);
}

}  // namespace
}  // namespace sinew::launch

#include "components/robot/provider/cycle_deadline.h"

#include <gtest/gtest.h>

namespace sinew::provider {
namespace {

constexpr std::chrono::nanoseconds kDeadlinePeriod{1000};

TEST(CycleDeadline, DeadlinesAreOnePeriodApartWheneverTheWorkEnds) {
  CycleDeadline deadline(kDeadlinePeriod, 500);
  EXPECT_EQ(deadline.Next(), 1500);
  EXPECT_FALSE(deadline.Missed(700));
  EXPECT_EQ(deadline.Next(), 2500);
  EXPECT_FALSE(deadline.Missed(2500)) << "just in time";
  EXPECT_EQ(deadline.Next(), 3500);
  EXPECT_EQ(deadline.overruns(), 0u);
}

TEST(CycleDeadline, AnOverrunIsCountedAndCaughtUp) {
  CycleDeadline deadline(kDeadlinePeriod, 0);
  deadline.Next();
  EXPECT_TRUE(deadline.Missed(1001));
  EXPECT_EQ(deadline.Next(), 2000);
  EXPECT_TRUE(deadline.Missed(3'000)) << "one period late";
  EXPECT_EQ(deadline.Next(), 3000);
  EXPECT_EQ(deadline.overruns(), 2u);
}

TEST(CycleDeadline, NoBurstCatchesUpWithAStall) {
  CycleDeadline deadline(kDeadlinePeriod, 0);
  deadline.Next();
  EXPECT_TRUE(deadline.Missed(2'001)) << "more than one period late";
  EXPECT_EQ(deadline.deadline_ns(), 2'001);
  EXPECT_EQ(deadline.Next(), 3'001);
}

}  // namespace
}  // namespace sinew::provider

#include "components/robot/provider/work_time.h"

#include <gtest/gtest.h>

namespace sinew::provider {
namespace {

TEST(WorkTime, SumsWhatIsBetweenResumeAndPause) {
  WorkTime work;
  EXPECT_EQ(work.Quantile_us(0.5), 0.0) << "no cycle yet";
  work.Resume(1'000'000);
  work.Pause(1'020'000);
  work.Resume(4'000'000);  // the wait in between does not count
  work.Pause(4'015'999);
  work.EndCycle();
  EXPECT_EQ(work.cycles(), 1U);
  EXPECT_EQ(work.Quantile_us(0.5), 36.0) << "35.999 us";
}

TEST(WorkTime, QuantilesAreOfCycles) {
  WorkTime work;
  for (int i = 1; i <= 1000; ++i) {
    work.Resume(0);
    work.Pause(i == 1000 ? 3'000'500'000 : 1000 * (i % 10) + 500);
    work.EndCycle();
  }
  EXPECT_EQ(work.Quantile_us(0.0), 1.0);
  EXPECT_EQ(work.Quantile_us(0.499), 5.0) << "0.5 to 4.5 us";
  EXPECT_EQ(work.Quantile_us(0.5), 6.0);
  EXPECT_EQ(work.Quantile_us(0.999), 10.0);
  EXPECT_EQ(work.Quantile_us(1.0), 20'000.0) << "the end of the scale";
}

}  // namespace
}  // namespace sinew::provider

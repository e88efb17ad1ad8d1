#include "components/provider/work_time.h"

#include <gtest/gtest.h>

#include <thread>

namespace sinew::provider {
namespace {

TEST(WorkTime, SumsWhatIsBetweenResumeAndPause) {
  WorkTime work;
  EXPECT_EQ(work.Quantile_us(0.5), 0.0) << "no cycle yet";
  for (int i = 0; i < 3; ++i) {
    work.Resume();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    work.Pause();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));  // a wait does not count
    work.Resume();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    work.Pause();
    work.EndCycle();
  }
  EXPECT_EQ(work.cycles(), 3U);
  EXPECT_GE(work.Quantile_us(0.0), 4000.0) << "both parts, of the shortest";
  EXPECT_LT(work.Quantile_us(0.0), 20000.0) << "and not the wait";
}

TEST(WorkTime, QuantilesAreOfCycles) {
  WorkTime work;
  for (int i = 0; i < 99; ++i) work.EndCycle();
  work.Resume();
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  work.Pause();
  work.EndCycle();
  EXPECT_EQ(work.Quantile_us(0.5), 1.0);
  EXPECT_GE(work.Quantile_us(1.0), 3000.0);
}

}  // namespace
}  // namespace sinew::provider

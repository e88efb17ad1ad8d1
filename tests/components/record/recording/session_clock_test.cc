// Stamps of a clock that was set back.
#include "components/record/recording/session_clock.h"

#include <gtest/gtest.h>

namespace sinew::recording {
namespace {

TEST(SessionClock, OfAClockThatIsLeftAloneStampsAreTimes) {
  SessionClock clock;
  for (const std::int64_t stamp_ns : {0, 10, 25, 25, 90}) {
    EXPECT_EQ(clock.Take(static_cast<std::uint64_t>(stamp_ns), stamp_ns), stamp_ns);
  }
  EXPECT_EQ(clock.set_back_ns(), 0);
  EXPECT_EQ(clock.ShiftOf(90), 0);
}

TEST(SessionClock, GoesOnByTheStepBeforeWhenItIsSetBack) {
  SessionClock clock;
  EXPECT_EQ(clock.Take(0, 1000), 1000);
  EXPECT_EQ(clock.Take(1, 1010), 1010);
  EXPECT_EQ(clock.Take(2, 520), 1020);  // by 500
  EXPECT_EQ(clock.Take(3, 530), 1030);
  EXPECT_EQ(clock.Take(5, 0), 1050);  // and by 550 more, two ticks later
  EXPECT_EQ(clock.set_back_ns(), 1050);
  EXPECT_EQ(clock.ShiftOf(1), 0);
  EXPECT_EQ(clock.ShiftOf(2), 500);
  EXPECT_EQ(clock.ShiftOf(4), 500);
  EXPECT_EQ(clock.ShiftOf(5), 1050);
}

TEST(SessionTimes, FollowOneAnotherAndGoOnWhereTheClockWasSetBack) {
  const SessionTimes times(
      {{7, 0, 100}, {7, 1, 110}, {7, 3, 60}, {7, 2, 50}, {3, 0, 0}, {3, 1, 10}, {4, 0, 500}});
  EXPECT_EQ(times.sessions(), (std::vector<std::uint64_t>{7, 3, 4}));
  EXPECT_EQ(times.ShiftOf(7, 1), 0);
  EXPECT_EQ(50 + times.ShiftOf(7, 2), 120);
  EXPECT_EQ(60 + times.ShiftOf(7, 3), 130);
  EXPECT_EQ(0 + times.ShiftOf(3, 0), 130);
  EXPECT_EQ(times.ShiftOf(4, 0), 0);  // later anyway
  EXPECT_EQ(times.ShiftOf(5, 0), 0);  // not there
  EXPECT_EQ(times.start_ns(), 100);
  EXPECT_EQ(times.end_ns(), 500);
}

TEST(TickOrder, TicksOfASessionGrow) {
  TickOrder order;
  EXPECT_TRUE(order.Take(1, 5));
  EXPECT_TRUE(order.Take(2, 0));
  EXPECT_TRUE(order.Take(1, 5));
  EXPECT_TRUE(order.Take(1, 6));
  EXPECT_FALSE(order.Take(1, 4));
}

}  // namespace
}  // namespace sinew::recording

#include "components/robot/control/follower.h"

#include <gtest/gtest.h>

#include <limits>

namespace sinew::control {
namespace {

types::JointArray<double> Torque(double torque_Nm) {
  types::JointArray<double> torques{};
  torques[0] = torque_Nm;
  return torques;
}

// A standby whose command is the owner's but for an offset that its integral lacks. The owner's
// commands arrive `delay` ticks after the own ones were made. Returns the offset that is left.
double OffsetAfter(int ticks, int delay) {
  Follower follower;
  double missing_Nm = 0.3;
  const auto owner_Nm = [](int tick) { return 0.01 * tick; };
  for (int k = 1; k <= ticks; ++k) {
    const auto tick = static_cast<std::uint64_t>(k);
    if (k > delay) {
      const auto give = follower.Compare(7, tick - static_cast<std::uint64_t>(delay),
                                         Torque(owner_Nm(k - delay)));
      if (give) missing_Nm -= (*give)[0];
    }
    follower.Made(7, tick, Torque(owner_Nm(k) - missing_Nm));
  }
  return missing_Nm;
}

TEST(Follower, TakesTheDifferenceOnceHoweverLateTheOwnersCommandsAre) {
  for (const int delay : {1, 2, 5, 20}) EXPECT_NEAR(OffsetAfter(60, delay), 0.0, 1e-12) << delay;
}

TEST(Follower, ComparesCommandsOfOneTickOnly) {
  Follower follower;
  follower.Made(7, 10, Torque(1.0));
  EXPECT_FALSE(follower.Compare(7, 9, Torque(2.0)).has_value());
  EXPECT_FALSE(follower.Compare(7, 11, Torque(2.0)).has_value());
  EXPECT_FALSE(follower.Compare(8, 10, Torque(2.0)).has_value()) << "another session's";
  const auto give = follower.Compare(7, 10, Torque(2.0));
  ASSERT_TRUE(give.has_value());
  EXPECT_EQ((*give)[0], 1.0);
  EXPECT_EQ((*give)[1], 0.0);
}

TEST(Follower, ForgetsWhatIsTooOldAndOtherSessions) {
  Follower follower;
  for (std::uint64_t tick = 1; tick <= Follower::kTicksKept + 1; ++tick) {
    follower.Made(7, tick, Torque(0.0));
  }
  EXPECT_FALSE(follower.Compare(7, 1, Torque(1.0)).has_value());
  EXPECT_TRUE(follower.Compare(7, 2, Torque(1.0)).has_value());
  follower.Made(8, 2, Torque(0.0));
  EXPECT_FALSE(follower.Compare(8, 5, Torque(1.0)).has_value());
  EXPECT_TRUE(follower.Compare(8, 2, Torque(1.0)).has_value());
}

TEST(Follower, TheSameCommandAgainChangesNothing) {
  Follower follower;
  follower.Made(7, 10, Torque(1.0));
  ASSERT_TRUE(follower.Compare(7, 10, Torque(3.0)).has_value());
  const auto again = follower.Compare(7, 10, Torque(3.0));
  ASSERT_TRUE(again.has_value());
  EXPECT_EQ((*again)[0], 0.0);
}

}  // namespace
}  // namespace sinew::control

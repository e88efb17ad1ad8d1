#include "components/base/types/did_you_mean.h"

#include <gtest/gtest.h>

namespace sinew::types {
namespace {

TEST(DidYouMean, TheNearestWordIsNamedAndAStrangeOneNone) {
  const std::vector<std::string> known = {"joint_state", "joint_command", "imu"};
  EXPECT_EQ(DidYouMean("joint_stat", known), "; did you mean 'joint_state'?");
  EXPECT_EQ(DidYouMean("jiont_comand", known), "; did you mean 'joint_command'?");
  EXPECT_EQ(DidYouMean("iu", known), "");
  EXPECT_EQ(DidYouMean("weather", known), "");
  EXPECT_EQ(DidYouMean("", known), "");
  EXPECT_EQ(DidYouMean("imu", {}), "");
  EXPECT_EQ(NoSuch("topic", "imus", {"imu", "regime"}),
            "no topic 'imus', expected one of: imu, regime; did you mean 'imu'?");
  EXPECT_EQ(NoSuch("topic", "imu", {}), "no topic 'imu', expected one of: none");
}

}  // namespace
}  // namespace sinew::types

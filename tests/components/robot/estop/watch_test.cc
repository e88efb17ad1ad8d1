#include "components/robot/estop/watch.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::estop {
namespace {

using ::testing::HasSubstr;

constexpr std::int64_t kMs = 1'000'000;

TEST(EstopWatch, NothingRequiredIsNoProblem) { EXPECT_EQ(Watch({}, 0).Problem(1'000 * kMs), ""); }

TEST(EstopWatch, EveryRequiredOneHasToBeHeard) {
  Watch watch({"button", "door"}, 0);
  EXPECT_EQ(watch.Problem(300 * kMs), "") << "since the begin";
  watch.Hear("button", false, "", 200 * kMs);
  EXPECT_THAT(watch.Problem(312 * kMs), HasSubstr("estop 'door' is silent for 312 ms, limit 300"));
  watch.Hear("door", false, "", 310 * kMs);
  EXPECT_EQ(watch.Problem(500 * kMs), "");
  EXPECT_THAT(watch.Problem(501 * kMs), HasSubstr("estop 'button' is silent for 301 ms"));
}

TEST(EstopWatch, AHeldInputIsAProblemUntilItIsReleased) {
  Watch watch({"button"}, 0);
  watch.Hear("button", true, "held: js0", 10 * kMs);
  EXPECT_EQ(watch.Problem(20 * kMs), "estop 'button': held: js0");
  watch.Hear("another", false, "", 30 * kMs);
  EXPECT_NE(watch.Problem(40 * kMs), "") << "of another name";
  watch.Hear("button", true, "", 50 * kMs);
  EXPECT_NE(watch.Problem(60 * kMs), "") << "whatever it says";
  watch.Hear("button", false, "", 70 * kMs);
  EXPECT_EQ(watch.Problem(80 * kMs), "");
}

}  // namespace
}  // namespace sinew::estop

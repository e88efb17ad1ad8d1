#include "reproduction/squat_test/squat_recording.h"

#include <gtest/gtest.h>

#include <numbers>
#include <stdexcept>

#include "tests/reproduction/squat_test/squats.h"

namespace sinew::squat_test {
namespace {

TEST(SquatRecording, TheMeanSquareErrorIsOfItsPartOfTime) {
  const SquatRecording recording = Tracked(10.0, [](double t) { return t < 5.0 ? 0.1 : 0.3; });
  EXPECT_NEAR(MeanSquareError(recording, 0.0, 5.0), 0.01, 1e-12);
  EXPECT_NEAR(MeanSquareError(recording, 5.0, 10.0), 0.09, 1e-12);
  EXPECT_NEAR(MeanSquareError(recording, 0.0, 10.0), 0.05, 1e-12);
  EXPECT_THROW(MeanSquareError(recording, 0.0, 10.5), std::invalid_argument);
}

TEST(SquatRecording, AFallIsATiltOrALowBase) {
  SquatRecording recording = Tracked(10.0, [](double) { return 0.0; });
  EXPECT_FALSE(FallTime(recording, 0.4).has_value());
  recording.height_m[700] = 0.79 * (0.75 - 0.4);
  EXPECT_DOUBLE_EQ(FallTime(recording, 0.4).value(), 7.0);
  recording.height_m[600] = 0.81 * (0.75 - 0.4);  // a deep squat is none
  EXPECT_DOUBLE_EQ(FallTime(recording, 0.4).value(), 7.0);
  recording.tilt_rad[500] = 31.0 / 180.0 * std::numbers::pi;
  EXPECT_DOUBLE_EQ(FallTime(recording, 0.4).value(), 5.0);
}

TEST(SquatRecording, TheSlidingErrorForgetsWhatIsOlderThanItsWindow) {
  const SquatRecording recording = Tracked(10.0, [](double t) { return t < 5.0 ? 0.2 : 0.0; });
  const std::vector<double> sliding = SlidingError(recording, 1.5);
  EXPECT_NEAR(sliding[0], 0.2, 1e-12);
  EXPECT_NEAR(sliding[499], 0.2, 1e-12);
  EXPECT_NEAR(sliding[574], 0.2 * std::sqrt(0.5), 1e-9);
  EXPECT_NEAR(sliding[660], 0.0, 1e-6);
}

}  // namespace
}  // namespace sinew::squat_test

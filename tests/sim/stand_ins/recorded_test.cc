#include "sim/stand_ins/recorded_reference/recorded.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sinew::stand_ins {
namespace {

using reference::Point;

TEST(Recorded, GivesTheRecordedValuesThemselvesAtTheirTimes) {
  std::vector<double> time_s;
  std::vector<Point> points;
  for (int k = 0; k < 1000; ++k) {
    time_s.push_back(5.0 + k / 240.0);
    points.push_back({std::sin(0.01 * k), std::cos(0.01 * k), -0.1 * k});
  }
  const Recorded recorded(time_s, points);
  EXPECT_NEAR(recorded.duration_s(), 999 / 240.0, 1e-12);
  for (int k = 0; k < 1000; ++k) {
    const Point at = recorded.At((k + 60) * (1.0 / 240.0) - 0.25);
    const Point& expected = points[static_cast<std::size_t>(k)];
    ASSERT_EQ(at.position_rad, expected.position_rad) << k;
    ASSERT_EQ(at.velocity_rad_s, expected.velocity_rad_s) << k;
    ASSERT_EQ(at.acceleration_rad_s2, expected.acceleration_rad_s2) << k;
  }
}

TEST(Recorded, GoesOnInAStraightLineOutsideAndBetweenSamples) {
  const Recorded recorded({0.0, 1.0}, {{1.0, -2.0, 4.0}, {3.0, 0.5, 0.0}});
  EXPECT_DOUBLE_EQ(recorded.At(-0.5).position_rad, 2.0);
  EXPECT_DOUBLE_EQ(recorded.At(-0.5).velocity_rad_s, -2.0);
  EXPECT_DOUBLE_EQ(recorded.At(0.25).position_rad, 1.5);
  EXPECT_DOUBLE_EQ(recorded.At(0.25).acceleration_rad_s2, 3.0);
  EXPECT_DOUBLE_EQ(recorded.At(3.0).position_rad, 4.0);
  EXPECT_EQ(recorded.At(3.0).acceleration_rad_s2, 0.0);
}

TEST(Recorded, RefusesWhatIsNoMotion) {
  EXPECT_THROW(Recorded({0.0}, {{}}), std::invalid_argument);
  EXPECT_THROW(Recorded({0.0, 1.0}, {{}}), std::invalid_argument);
  EXPECT_THROW(Recorded({0.0, 0.0}, {{}, {}}), std::invalid_argument);
  EXPECT_THROW(Recorded({0.0, 1.0}, {{}, {NAN, 0.0, 0.0}}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::stand_ins

#include "components/bodies/leg/squat.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace sinew::leg {
namespace {

LegGeometry SquatLeg() {
  LegGeometry g;
  g.thigh_m = 0.278;
  g.shank_m = 0.260;
  g.ankle_offset_m = 0.104;
  g.sole_in_ankle_m = {0.0, 0.0, -0.134};
  return g;
}

TEST(Squat, PutsTheSoleFlatBelowTheHip) {
  const LegGeometry g = SquatLeg();
  for (const double forward_m : {-0.05, 0.0, 0.08}) {
    for (double height_m = 0.15; height_m < 0.52; height_m += 0.01) {
      const auto motion = SquatAt(g, forward_m, {height_m, 0.0, 0.0});
      ASSERT_TRUE(motion.has_value()) << height_m;
      LegAngles q = LegAngles::Zero();
      q[kHipPitch] = motion->hip_pitch.position_rad;
      q[kKnee] = motion->knee.position_rad;
      q[kAnklePitch] = motion->ankle_pitch.position_rad;
      const Eigen::Isometry3d sole = Forward(g, q);
      ASSERT_LT((sole.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
      ASSERT_LT((sole.translation() - Eigen::Vector3d(forward_m, 0.0, -height_m - 0.238)).norm(),
                1e-12);
      // The same angles as the general inverse.
      ASSERT_LT((Inverse(g, sole).q - q).norm(), 1e-9);
    }
  }
}

TEST(Squat, VelocitiesAndAccelerationsAreThoseOfFiniteDifferences) {
  const LegGeometry g = SquatLeg();
  // A motion with all of velocity, acceleration and jerk.
  const auto hip = [](double t) -> HipHeight {
    const double w = 3.0;
    return {0.33 + 0.17 * std::sin(w * t), 0.17 * w * std::cos(w * t),
            -0.17 * w * w * std::sin(w * t)};
  };
  constexpr double kStep_s = 1e-5;
  // Of central differences: step^2 times the third derivative, and rounding 1e-16 / step.
  constexpr double kTolerance = 1e-6;
  for (const double forward_m : {-0.05, 0.0, 0.08}) {
    for (double t = 0.0; t < 2.1; t += 0.05) {
      const auto before = SquatAt(g, forward_m, hip(t - kStep_s));
      const auto at = SquatAt(g, forward_m, hip(t));
      const auto after = SquatAt(g, forward_m, hip(t + kStep_s));
      ASSERT_TRUE(before && at && after);
      for (const auto joint :
           {&SquatMotion::hip_pitch, &SquatMotion::knee, &SquatMotion::ankle_pitch}) {
        const JointMotion &a = (*before).*joint, &b = (*at).*joint, &c = (*after).*joint;
        const double scale = 1.0 + std::abs(b.acceleration_rad_s2);
        ASSERT_NEAR(b.velocity_rad_s, (c.position_rad - a.position_rad) / (2.0 * kStep_s),
                    kTolerance * scale)
            << t;
        ASSERT_NEAR(b.acceleration_rad_s2, (c.velocity_rad_s - a.velocity_rad_s) / (2.0 * kStep_s),
                    kTolerance * scale)
            << t;
      }
    }
  }
}

TEST(Squat, AStraightAFoldedAndAnUnreachedLegAreRefused) {
  const LegGeometry g = SquatLeg();
  const double straight_m = StraightHeight(g, 0.0);
  EXPECT_NEAR(straight_m, 0.538, 1e-15);
  EXPECT_NEAR(StraightHeight(g, 0.2), std::sqrt(0.538 * 0.538 - 0.04), 1e-15);
  EXPECT_EQ(StraightHeight(g, 0.6), 0.0);
  EXPECT_TRUE(SquatAt(g, 0.0, {straight_m - 1e-3, 0.1, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.0, {straight_m, 0.1, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.0, {straight_m + 0.1, 0.1, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.0, {0.018, 0.1, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.6, {0.2, 0.0, 0.0}));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SquatAt(g, 0.0, {nan, 0.0, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.0, {0.3, nan, 0.0}));
  EXPECT_FALSE(SquatAt(g, 0.0, {0.3, 0.0, nan}));
}

}  // namespace
}  // namespace sinew::leg

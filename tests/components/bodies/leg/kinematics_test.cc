#include "components/bodies/leg/kinematics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "tests/components/bodies/leg/declared_branch.h"
#include "tests/support/allocations.h"

namespace sinew::leg {
namespace {

constexpr double kExact = 1e-9;
constexpr int kStates = 10000;

// Lengths of Table 3.1; the sole is moved forward and aside so that it matters.
LegGeometry Biped(double side = 1.0) {
  LegGeometry g;
  g.hip_in_pelvis_m = {0.0, side * 0.075, 0.0};
  g.thigh_m = 0.278;
  g.shank_m = 0.260;
  g.ankle_offset_m = 0.104;
  g.sole_in_ankle_m = {0.01, side * 0.004, -0.134};
  return g;
}

double Uniform(std::mt19937_64& random, double lower, double upper) {
  return std::uniform_real_distribution<double>(lower, upper)(random);
}

// In the declared branch, off its borders: knee 0 and pi (there its angle is a square root of D),
// hip roll 90 degrees, hip beside the foot.
LegAngles RandomAngles(std::mt19937_64& random, const LegGeometry& g) {
  const double pi = std::numbers::pi;
  LegAngles q;
  do {
    q << Uniform(random, -pi, pi), Uniform(random, -1.5, 1.5), Uniform(random, -pi, pi),
        Uniform(random, 1e-3, pi - 1e-3), Uniform(random, -pi, pi), Uniform(random, -pi, pi);
  } while (!InDeclaredBranch(g, q) || g.ankle_offset_m + g.shank_m * std::cos(q[kAnklePitch]) +
                                              g.thigh_m * std::cos(q[kKnee] + q[kAnklePitch]) <
                                          1e-3);
  return q;
}

double AngleError(const LegAngles& a, const LegAngles& b) {
  double largest = 0.0;
  for (int i = 0; i < kLegJoints; ++i) {
    largest = std::max(largest, std::abs(std::remainder(a[i] - b[i], 2.0 * std::numbers::pi)));
  }
  return largest;
}

TEST(LegKinematics, AStraightLegHangsStraightDown) {
  const LegGeometry g = Biped();
  const Eigen::Isometry3d sole = Forward(g, LegAngles::Zero());
  EXPECT_LT((sole.translation() - Eigen::Vector3d(0.01, 0.079, -0.776)).norm(), 1e-15);
  EXPECT_LT((sole.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(LegKinematics, PositivePitchesMoveTheFootBackAndPositiveRollsToTheLeft) {
  const LegGeometry g = Biped();
  const double x = Forward(g, LegAngles::Zero()).translation().x();
  const double y = Forward(g, LegAngles::Zero()).translation().y();
  for (const LegJoint joint : {kHipPitch, kKnee, kAnklePitch}) {
    LegAngles q = LegAngles::Zero();
    q[joint] = 0.1;
    EXPECT_LT(Forward(g, q).translation().x(), x) << joint;
  }
  for (const LegJoint joint : {kHipRoll, kAnkleRoll}) {
    LegAngles q = LegAngles::Zero();
    q[joint] = 0.1;
    EXPECT_GT(Forward(g, q).translation().y(), y) << joint;  // about x: what is below moves to +y
  }
}

TEST(LegKinematics, ForwardIsTheProductOfTheJointsTransforms) {
  std::mt19937_64 random(3);
  const LegGeometry g = Biped();
  using Eigen::AngleAxisd, Eigen::Translation3d, Eigen::Vector3d;
  for (int i = 0; i < 100; ++i) {
    const LegAngles q = RandomAngles(random, g);
    const Eigen::Isometry3d product =
        Translation3d(g.hip_in_pelvis_m) * AngleAxisd(q[0], Vector3d::UnitZ()) *
        AngleAxisd(q[1], Vector3d::UnitX()) * AngleAxisd(q[2], Vector3d::UnitY()) *
        Translation3d(0, 0, -g.thigh_m) * AngleAxisd(q[3], Vector3d::UnitY()) *
        Translation3d(0, 0, -g.shank_m) * AngleAxisd(q[4], Vector3d::UnitY()) *
        Translation3d(0, 0, -g.ankle_offset_m) * AngleAxisd(q[5], Vector3d::UnitX()) *
        Translation3d(g.sole_in_ankle_m);
    ASSERT_LT((Forward(g, q).matrix() - product.matrix()).cwiseAbs().maxCoeff(), 1e-14);
  }
}

TEST(LegKinematics, InverseOfForwardGivesTheAnglesBack) {
  std::mt19937_64 random(1);
  for (const double side : {1.0, -1.0}) {
    const LegGeometry g = Biped(side);
    for (int i = 0; i < kStates; ++i) {
      const LegAngles q = RandomAngles(random, g);
      const LegSolution solution = Inverse(g, Forward(g, q));
      ASSERT_TRUE(solution.ok()) << q.transpose();
      ASSERT_LT(AngleError(solution.q, q), kExact) << q.transpose() << "\n"
                                                   << solution.q.transpose();
    }
  }
}

TEST(LegKinematics, ForwardOfInverseGivesThePoseBack) {
  std::mt19937_64 random(2);
  const LegGeometry g = Biped();
  int reached = 0;
  while (reached < kStates) {
    // Any orientation and any place about the hip.
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = Eigen::Quaterniond(Uniform(random, -1, 1), Uniform(random, -1, 1),
                                       Uniform(random, -1, 1), Uniform(random, -1, 1))
                        .normalized()
                        .toRotationMatrix();
    pose.translation() =
        g.hip_in_pelvis_m + 0.8 * Eigen::Vector3d(Uniform(random, -1, 1), Uniform(random, -1, 1),
                                                  Uniform(random, -1, 1));
    const LegSolution solution = Inverse(g, pose);
    ASSERT_NE(solution.reach, Reach::kUndefined);
    if (!solution.ok()) continue;
    ++reached;
    ASSERT_TRUE(InDeclaredBranch(g, solution.q)) << solution.q.transpose();
    ASSERT_LT((Forward(g, solution.q).matrix() - pose.matrix()).cwiseAbs().maxCoeff(), kExact)
        << solution.q.transpose();
  }
}

TEST(LegKinematics, TheSoleIsExactWithAStraightKnee) {
  const LegGeometry g = Biped();
  LegAngles q;
  q << 0.3, 0.2, -0.4, 0.0, 0.1, -0.2;
  const Eigen::Isometry3d pose = Forward(g, q);
  const LegSolution solution = Inverse(g, pose);
  EXPECT_TRUE(solution.ok());
  EXPECT_LT((Forward(g, solution.q).matrix() - pose.matrix()).cwiseAbs().maxCoeff(), kExact);
}

TEST(LegKinematics, OutOfReachReportsByHowMuchAndTheNearestLeg) {
  const LegGeometry g = Biped();
  Eigen::Isometry3d pose = Forward(g, LegAngles::Zero());
  pose.translation().z() -= 0.05;
  LegSolution solution = Inverse(g, pose);
  EXPECT_EQ(solution.reach, Reach::kTooFar);
  EXPECT_NEAR(solution.miss_m, 0.05, 1e-12);
  EXPECT_EQ(solution.q[kKnee], 0.0);
  // The straight leg in that direction, the sole as asked.
  const Eigen::Isometry3d nearest = Forward(g, solution.q);
  EXPECT_LT((nearest.linear() - pose.linear()).norm(), 1e-12);
  EXPECT_NEAR((nearest.translation() - pose.translation()).norm(), 0.05, 1e-12);

  pose.translation().z() += 0.05 + 0.538 - 0.010;  // the ankle 0.010 below the hip
  solution = Inverse(g, pose);
  EXPECT_EQ(solution.reach, Reach::kTooNear);
  EXPECT_NEAR(solution.miss_m, 0.008, 1e-12);
  EXPECT_NEAR(solution.q[kKnee], std::numbers::pi, 1e-12);
}

TEST(LegKinematics, WhatHasNoSolutionOrIsNotFiniteIsUndefined) {
  const LegGeometry g = Biped();
  Eigen::Isometry3d pose = Forward(g, LegAngles::Zero());
  pose.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Inverse(g, pose).reach, Reach::kUndefined);
  pose = Forward(g, LegAngles::Zero());
  pose.linear() *= 1.01;
  EXPECT_EQ(Inverse(g, pose).reach, Reach::kUndefined);
  pose.linear() = Eigen::Vector3d(1.0, 1.0, -1.0).asDiagonal();  // a mirror
  EXPECT_EQ(Inverse(g, pose).reach, Reach::kUndefined);
  // The hip on the ankle roll axis: any roll would do.
  pose.linear() = Eigen::Matrix3d::Identity();
  pose.translation() = g.hip_in_pelvis_m + Eigen::Vector3d(0.2, 0.0, 0.0) + g.sole_in_ankle_m;
  EXPECT_EQ(Inverse(g, pose).reach, Reach::kUndefined);
  // The hip rolled by 90 degrees: yaw and pitch turn about the same line.
  LegAngles q;
  q << 0.0, 0.5 * std::numbers::pi, 0.1, 0.5, 0.1, 0.1;
  EXPECT_EQ(Inverse(g, Forward(g, q)).reach, Reach::kUndefined);
}

TEST(LegKinematics, TheLegsAreMirrored) {
  std::mt19937_64 random(4);
  const LegGeometry left = Biped(1.0), right = Biped(-1.0);
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1.0, -1.0, 1.0).asDiagonal();
  for (int i = 0; i < 1000; ++i) {
    const LegAngles q = RandomAngles(random, left);
    LegAngles mirrored = q;
    for (const LegJoint joint : {kHipYaw, kHipRoll, kAnkleRoll}) mirrored[joint] = -q[joint];
    const Eigen::Isometry3d a = Forward(left, q), b = Forward(right, mirrored);
    ASSERT_LT((b.translation() - mirror * a.translation()).norm(), 1e-14);
    ASSERT_LT((b.linear() - mirror * a.linear() * mirror).norm(), 1e-14);
    ASSERT_LT(AngleError(Inverse(right, b).q, mirrored), kExact);
  }
}

TEST(LegKinematics, AllocatesNothing) {
  const LegGeometry g = Biped();
  LegAngles q;
  q << 0.3, 0.2, -0.4, 0.7, 0.1, -0.2;
  const long before = test::Allocations();
  for (int i = 0; i < 100; ++i) q = Inverse(g, Forward(g, q)).q;
  EXPECT_EQ(test::Allocations(), before);
}

}  // namespace
}  // namespace sinew::leg

// Bullet's accelerations against closed forms.
#include "sim/world/chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace sinew::world {
namespace {

constexpr double kG = 9.81;
// Accelerations of order 100 come from differences of velocities in double precision.
constexpr double kTolerance = 1e-10;

// Two links in the x-z plane, axes -y (positive angles lift +x), with centres of mass off the
// link's line and tilted principal axes.
arm::Chain TwoLinks() {
  arm::Chain chain;
  arm::Body first, second;
  first.joint_name = "one";
  first.moves = true;
  first.axis = -Eigen::Vector3d::UnitY();
  first.mass_kg = 1.3;
  first.com_m = {0.21, 0.05, 0.0};
  first.inertia_kg_m2 << 0.02, 0.003, 0.002, 0.003, 0.05, 0.001, 0.002, 0.001, 0.045;
  second = first;
  second.joint_name = "two";
  second.parent = 0;
  second.parent_from_joint.translate(Eigen::Vector3d(0.4, 0.1, 0.0));
  second.mass_kg = 0.7;
  second.com_m = {0.15, -0.02, 0.0};
  second.inertia_kg_m2 *= 0.3;
  chain.bodies = {first, second};
  return chain;
}

// The textbook equations of the planar two-link arm: H a + c + g = tau.
struct Planar {
  double m1 = 1.3, m2 = 0.7, l1 = 0.4, r1 = 0.21, r2 = 0.15, i1 = 0.05, i2 = 0.015;

  Eigen::Matrix2d Inertia(double q2) const {
    const double c = m2 * l1 * r2 * std::cos(q2);
    Eigen::Matrix2d h;
    h << i1 + i2 + m1 * r1 * r1 + m2 * (l1 * l1 + r2 * r2) + 2.0 * c, i2 + m2 * r2 * r2 + c,
        i2 + m2 * r2 * r2 + c, i2 + m2 * r2 * r2;
    return h;
  }
  Eigen::Vector2d Bias(const Eigen::Vector2d& q, const Eigen::Vector2d& v) const {
    const double s = m2 * l1 * r2 * std::sin(q[1]);
    const double g2 = m2 * kG * r2 * std::cos(q[0] + q[1]);
    return {-s * (2.0 * v[0] * v[1] + v[1] * v[1]) + (m1 * r1 + m2 * l1) * kG * std::cos(q[0]) + g2,
            s * v[0] * v[0] + g2};
  }
};

TEST(RigidChain, MovesATwoLinkArmAsItsEquationsSay) {
  RigidChain rigid(TwoLinks());
  const Planar planar;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  JointVector a(2);
  JointMatrix inverse(2, 2);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector2d q(uniform(random), uniform(random)), v(uniform(random), uniform(random));
    rigid.SetState(q, v);
    rigid.Solve(&a, &inverse);
    const Eigen::Matrix2d expected_inverse = planar.Inertia(q[1]).inverse();
    const Eigen::Vector2d expected = -expected_inverse * planar.Bias(q, v);
    EXPECT_LT((a - expected).norm(), kTolerance) << a.transpose() << " / " << expected.transpose();
    EXPECT_LT((inverse - expected_inverse).norm(), kTolerance);
  }
}

TEST(RigidChain, AcceleratesAPrismaticAxisByForceOverMass) {
  arm::Chain chain;
  arm::Body slide;
  slide.joint_name = "axis";
  slide.moves = slide.prismatic = true;
  slide.axis = Eigen::Vector3d(0.6, 0.0, 0.8);
  slide.mass_kg = 95.0;
  slide.com_m = {0.3, 0.2, 0.1};
  slide.inertia_kg_m2 = Eigen::Matrix3d::Identity();
  chain.bodies = {slide};
  RigidChain rigid(chain);
  JointVector a(1);
  JointMatrix inverse(1, 1);
  rigid.SetState(JointVector::Constant(1, 0.2), JointVector::Constant(1, 0.3));
  rigid.Solve(&a, &inverse);
  EXPECT_NEAR(inverse(0, 0), 1.0 / 95.0, 1e-15);
  EXPECT_NEAR(a[0], -kG * 0.8, kTolerance);
}

// A slide carrying a pendulum, with a fixed link between: H = [m1 + m2, m2 r sin; ., i + m2 r^2].
TEST(RigidChain, CouplesASlideAndAPendulumThroughAFixedLink) {
  arm::Chain chain;
  arm::Body slide, bracket, pendulum;
  slide.joint_name = "slide";
  slide.moves = slide.prismatic = true;
  slide.mass_kg = 2.0;
  slide.inertia_kg_m2 = Eigen::Matrix3d::Identity();
  bracket.parent = 0;
  bracket.parent_from_joint.translate(Eigen::Vector3d(0.1, 0.2, 0.3));
  pendulum.joint_name = "swing";
  pendulum.parent = 1;
  pendulum.moves = true;
  pendulum.axis = -Eigen::Vector3d::UnitY();
  pendulum.mass_kg = 0.5;
  pendulum.com_m = {0.4, 0.0, 0.0};
  pendulum.inertia_kg_m2 = 0.01 * Eigen::Matrix3d::Identity();
  chain.bodies = {slide, bracket, pendulum};
  RigidChain rigid(chain);
  ASSERT_EQ(rigid.joint_count(), 2);
  const double q = 0.7, w = 1.9, r = 0.4, m = 0.5;
  JointVector position(2), velocity(2), a(2);
  JointMatrix inverse(2, 2);
  position << 0.3, q;
  velocity << -0.2, w;
  rigid.SetState(position, velocity);
  rigid.Solve(&a, &inverse);
  Eigen::Matrix2d h;
  h << 2.5, -m * r * std::sin(q), -m * r * std::sin(q), 0.01 + m * r * r;
  const Eigen::Vector2d bias(-m * r * std::cos(q) * w * w, m * kG * r * std::cos(q));
  EXPECT_LT((a - Eigen::Vector2d(-h.inverse() * bias)).norm(), kTolerance);
  EXPECT_LT((inverse - JointMatrix(h.inverse())).norm(), kTolerance);
}

}  // namespace
}  // namespace sinew::world

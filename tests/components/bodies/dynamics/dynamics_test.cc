// Oracle: Bullet's articulated bodies (sim/world/chain.h), another algorithm by other people, whose
// inverse mass matrix and accelerations our torques must reproduce.
#include "components/bodies/dynamics/dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "sim/world/chain.h"
#include "tests/components/bodies/dynamics/random_arm.h"

namespace sinew::arm {
namespace {

Eigen::VectorXd Random(int n, std::mt19937_64& random, double size) {
  std::uniform_real_distribution<double> value(-size, size);
  Eigen::VectorXd out(n);
  for (double& x : out) x = value(random);
  return out;
}

TEST(ArmDynamics, ForwardDynamicsGivesBackTheAccelerationWhoseTorqueItComputed) {
  const Chain chain = RandomArm();
  const ArmDynamics dynamics(chain);
  world::RigidChain bullet(chain);
  ASSERT_EQ(dynamics.joints(), bullet.joint_count());
  std::mt19937_64 random(4);
  for (int round = 0; round < 50; ++round) {
    const Eigen::VectorXd q = Random(4, random, 2.0), v = Random(4, random, 3.0),
                          a = Random(4, random, 5.0);
    const Eigen::VectorXd torque = dynamics.Torque(q, v, a, dynamics.nominal());
    world::JointVector q_b = q, v_b = v, free(4);
    world::JointMatrix inverse(4, 4);
    bullet.SetState(q_b, v_b);
    bullet.Solve(&free, &inverse);
    const Eigen::VectorXd back = free + inverse * torque;
    // Accelerations of order 10 out of differences in double precision.
    EXPECT_LT((back - a).norm(), 1e-8 * (1.0 + a.norm())) << back.transpose() << "\n"
                                                          << a.transpose();
  }
}

TEST(ArmDynamics, TheRegressorTimesTheParametersIsTheRecursion) {
  const ArmDynamics dynamics(RandomArm());
  std::mt19937_64 random(5);
  for (int round = 0; round < 50; ++round) {
    const Eigen::VectorXd q = Random(4, random, 2.0), v = Random(4, random, 3.0),
                          a = Random(4, random, 5.0);
    const Eigen::VectorXd phi = Random(dynamics.parameters(), random, 1.0);
    const Eigen::VectorXd torque = dynamics.Torque(q, v, a, phi);
    EXPECT_LT((dynamics.Regressor(q, v, a) * phi - torque).norm(), 1e-12 * (1.0 + torque.norm()));
  }
}

TEST(ArmDynamics, APointMassOnAHorizontalAxisIsAPendulum) {
  Chain chain;
  Body body;
  body.joint_name = body.link_name = "pendulum";
  body.moves = true;
  body.axis = -Eigen::Vector3d::UnitY();
  body.mass_kg = 2.0;
  body.com_m = {0.5, 0.0, 0.0};
  chain.bodies = {body};
  const ArmDynamics dynamics(chain);
  const auto one = [](double x) { return Eigen::VectorXd::Constant(1, x); };
  const double torque = dynamics.Torque(one(0.3), one(4.0), one(2.0), dynamics.nominal())[0];
  EXPECT_NEAR(torque, 2.0 * 0.25 * 2.0 + 2.0 * 9.81 * 0.5 * std::cos(0.3), 1e-12);
}

TEST(ArmDynamics, BaseParametersAreAllThatTorquesCanShow) {
  const ArmDynamics dynamics(RandomArm());
  const BaseParameters base = FindBaseParameters(dynamics);
  EXPECT_EQ(base.independent.size() + base.dependent.size(),
            static_cast<std::size_t>(dynamics.parameters()));
  EXPECT_LT(base.independent.size(), static_cast<std::size_t>(dynamics.parameters()));
  // Another choice of all parameters with the same base parameters needs the same torques.
  std::mt19937_64 random(6);
  Eigen::VectorXd other = dynamics.nominal();
  for (const int i : base.dependent) other[i] += 1.0;
  const Eigen::VectorXd change = base.Of(dynamics.nominal()) - base.Of(other);
  for (std::size_t i = 0; i < base.independent.size(); ++i) {
    other[base.independent[i]] += change[static_cast<Eigen::Index>(i)];
  }
  for (int round = 0; round < 20; ++round) {
    const Eigen::VectorXd q = Random(4, random, 2.0), v = Random(4, random, 3.0),
                          a = Random(4, random, 5.0);
    const Eigen::VectorXd torque = dynamics.Torque(q, v, a, dynamics.nominal());
    EXPECT_LT((dynamics.Torque(q, v, a, other) - torque).norm(), 1e-8 * (1.0 + torque.norm()));
  }
}

TEST(ArmDynamics, ARobotThatDoesNotMoveIsRefused) {
  EXPECT_THROW(ArmDynamics(Chain{}), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::arm

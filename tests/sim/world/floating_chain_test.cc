// The chain on a floating base: laws, finite differences; floating_chain_dart_test.cc has DART.
#include "sim/world/floating_chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "tests/sim/world/random_tree.h"
#include "tests/support/allocations.h"

namespace sinew::world {
namespace {

// Relative, of the same arithmetic in another order.
constexpr double kAgreement = 1e-12;

// A chain without joints is a rigid body: Newton and Euler in closed form, the centre of mass off
// the origin.
TEST(FloatingChain, OfOneBodyFollowsNewtonAndEuler) {
  arm::Chain chain = RandomTree(3, 1);
  chain.bodies.clear();
  FloatingChain body(chain);
  RandomStates random(5);
  Eigen::VectorXd a(kBaseFreedom);
  for (int k = 0; k < 100; ++k) {
    const FloatingState state = random.State(body);
    const Eigen::Vector3d force = random.Vector(3, 30.0), point = random.Vector(3, 0.3);
    body.SetState(state);
    body.Solve(Eigen::VectorXd(), std::vector<LinkForce>{{kBaseBody, point, force}}, a);
    const Eigen::Matrix3d rotation = state.orientation.toRotationMatrix();
    const Eigen::Vector3d w = state.velocity.head<3>();
    const Eigen::Vector3d lever = rotation * chain.base.com_m;
    const Eigen::Matrix3d inertia = rotation * chain.base.inertia_kg_m2 * rotation.transpose();
    const Eigen::Vector3d moment = (rotation * point - lever).cross(force);
    const Eigen::Vector3d turning = inertia.inverse() * (moment - w.cross(inertia * w));
    const Eigen::Vector3d linear = force / chain.base.mass_kg + body.gravity_m_s2() -
                                   turning.cross(lever) - w.cross(w.cross(lever));
    EXPECT_LT((a.head<3>() - turning).norm(), kAgreement * turning.norm());
    EXPECT_LT((a.tail<3>() - linear).norm(), kAgreement * linear.norm());
  }
}

TEST(FloatingChain, ResponsesAreTheDifferencesOfAccelerations) {
  FloatingChain chain(RandomTree(4, 6));
  RandomStates random(6);
  chain.SetState(random.State(chain));
  const int n = chain.joint_count();
  Eigen::VectorXd without(chain.freedom()), with(chain.freedom());
  Eigen::MatrixXd inverse(chain.freedom(), chain.freedom());
  chain.Solve(Eigen::VectorXd::Zero(n), {}, without);
  chain.Responses(inverse);
  EXPECT_LT((inverse - inverse.transpose()).norm(), kAgreement * inverse.norm());
  for (int j = 0; j < n; ++j) {
    chain.Solve(Eigen::VectorXd::Unit(n, j), {}, with);
    EXPECT_LT((with - without - inverse.col(kBaseFreedom + j)).norm(),
              kAgreement * (without.norm() + inverse.norm()));
  }
  for (int axis = 0; axis < 3; ++axis) {
    const LinkForce force{.force_N = Eigen::Vector3d::Unit(axis)};
    chain.Solve(Eigen::VectorXd::Zero(n), {&force, 1}, with);
    EXPECT_LT((with - without - inverse.col(3 + axis)).norm(),
              kAgreement * (without.norm() + inverse.norm()));
  }
}

TEST(FloatingChain, PointsMoveAsFiniteDifferencesSay) {
  FloatingChain chain(RandomTree(9, 8));
  RandomStates random(2);
  FloatingState state = random.State(chain);
  constexpr double kStep_s = 1e-6;
  // Central differences: h^2 times the third derivative, of order 1e3 here.
  constexpr double kTolerance_m_s = 1e-7;
  for (int body = kBaseBody; body < chain.body_count(); ++body) {
    const Eigen::Vector3d point = random.Vector(3, 0.2);
    FloatingState before = state, after = state;
    Drift(-kStep_s, &before);
    Drift(kStep_s, &after);
    chain.SetState(before);
    const Eigen::Vector3d first = chain.Point(body, point).position_m;
    chain.SetState(after);
    const Eigen::Vector3d second = chain.Point(body, point).position_m;
    chain.SetState(state);
    const Eigen::Vector3d expected = (second - first) / (2.0 * kStep_s);
    EXPECT_LT((chain.Point(body, point).velocity_m_s - expected).norm(), kTolerance_m_s) << body;
  }
}

TEST(FloatingChain, DriftTurnsByTheExponentialAndStaysAUnitQuaternion) {
  FloatingState state;
  state.velocity = Eigen::VectorXd::Zero(kBaseFreedom);
  state.velocity.head<3>() = Eigen::Vector3d(0.3, -2.0, 1.1);
  const Eigen::Vector3d w = state.velocity.head<3>();
  constexpr int kSteps = 100000;
  constexpr double kStep_s = 1e-4;
  for (int k = 0; k < kSteps; ++k) Drift(kStep_s, &state);
  const Eigen::Quaterniond expected(Eigen::AngleAxisd(kSteps * kStep_s * w.norm(), w.normalized()));
  // Rounding of 1e5 products.
  EXPECT_LT(state.orientation.angularDistance(expected), 1e-11);
  EXPECT_NEAR(state.orientation.norm(), 1.0, 1e-15);
}

TEST(FloatingChain, RefusesABaseThatNoBodyHas) {
  arm::Chain chain = RandomTree(1, 2);
  const auto refuses = [](const arm::Chain& bad) {
    EXPECT_THROW(FloatingChain{bad}, std::invalid_argument);
  };
  arm::Chain bad = chain;
  bad.base.mass_kg = 0.0;
  refuses(bad);
  bad.base.mass_kg = std::nan("");
  refuses(bad);
  bad = chain;
  bad.base.inertia_kg_m2.setZero();
  refuses(bad);
  bad.base.inertia_kg_m2 = Eigen::Vector3d(1.0, 1.0, 3.0).asDiagonal();
  refuses(bad);
  bad.base.inertia_kg_m2(0, 1) = std::nan("");
  refuses(bad);
}

TEST(FloatingChain, SolvesWithoutAllocations) {
  FloatingChain chain(RandomTree(2, 14));
  RandomStates random(1);
  const FloatingState state = random.State(chain);
  const Eigen::VectorXd torque = random.Vector(chain.joint_count(), 5.0);
  const std::vector<LinkForce> forces = random.Forces(chain);
  Eigen::VectorXd a(chain.freedom());
  Eigen::MatrixXd inverse(chain.freedom(), chain.freedom());
  const auto all = [&] {
    chain.SetState(state);
    chain.Solve(torque, forces, a);
    chain.Responses(inverse);
  };
  all();
  const long before = test::Allocations();
  for (int k = 0; k < 10; ++k) all();
  EXPECT_EQ(test::Allocations(), before);
}

}  // namespace
}  // namespace sinew::world

// The chain on a floating and on a fixed base against DART, on random states of trees and bipeds.
#include "sim/world/floating_chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>
#include <string>

#include "sim/world/chain.h"
#include "tests/sim/world/biped.h"
#include "tests/sim/world/dart_skeleton.h"
#include "tests/sim/world/random_tree.h"
#include "tests/support/allocations.h"
#include "tests/support/skip.h"

namespace sinew::world {
namespace {

// Largest relative difference of accelerations and of inverse inertias over random states. The
// accelerations are those of random torques and a random force on every third body.
struct Difference {
  double acceleration = 0.0, response = 0.0;
};

double Relative(const Eigen::MatrixXd& ours, const Eigen::MatrixXd& reference) {
  return (ours - reference).norm() / reference.norm();
}

Difference FloatingAgainstDart(const arm::Chain& chain, int states, unsigned seed) {
  FloatingChain ours(chain);
  DartChain reference(chain, /*fixed_base=*/false);
  RandomStates random(seed);
  Eigen::VectorXd a(ours.freedom()), b(ours.freedom());
  Eigen::MatrixXd inverse(ours.freedom(), ours.freedom());
  Difference worst;
  for (int k = 0; k < states; ++k) {
    const FloatingState state = random.State(ours);
    const Eigen::VectorXd torque = random.Vector(ours.joint_count(), 20.0);
    const std::vector<LinkForce> forces = random.Forces(ours);
    ours.SetState(state);
    ours.Solve(torque, forces, a);
    ours.Responses(inverse);
    reference.SetState(state);
    reference.Solve(torque, forces, b);
    worst.acceleration = std::max(worst.acceleration, Relative(a, b));
    worst.response = std::max(worst.response, Relative(inverse, reference.Responses()));
  }
  return worst;
}

Difference FixedAgainstDart(const arm::Chain& chain, int states, unsigned seed) {
  RigidChain ours(chain);
  const FloatingChain sizes(chain);
  DartChain reference(chain, /*fixed_base=*/true);
  RandomStates random(seed);
  const int n = ours.joint_count();
  Eigen::VectorXd b(kBaseFreedom + n);
  JointVector a(n);
  JointMatrix inverse(n, n);
  Difference worst;
  for (int k = 0; k < states; ++k) {
    const FloatingState state = random.State(sizes);
    ours.SetState(state.joint_position_rad, state.velocity.tail(n));
    ours.Solve(&a, &inverse);
    reference.SetState(state);
    reference.Solve(Eigen::VectorXd::Zero(n), {}, b);
    worst.acceleration = std::max(worst.acceleration, Relative(a, b.tail(n)));
    worst.response = std::max(worst.response, Relative(inverse, reference.Responses()));
  }
  return worst;
}

// Found: at most 3.1e-14 (random trees), 8e-15 (bipeds).
constexpr double kAgreement = 1e-12;
constexpr int kStates = 2000;

// compare: FloatingAgainstDart or FixedAgainstDart.
template <typename Compare>
void ExpectAgreementOnRandomTrees(int moving, Compare compare) {
  constexpr int kTrees = 20;
  Difference worst;
  for (unsigned seed = 1; seed <= kTrees; ++seed) {
    const Difference found = compare(RandomTree(seed, moving), kStates / kTrees, seed);
    worst.acceleration = std::max(worst.acceleration, found.acceleration);
    worst.response = std::max(worst.response, found.response);
  }
  EXPECT_LT(worst.acceleration, kAgreement);
  EXPECT_LT(worst.response, kAgreement);
}

TEST(FloatingChain, AgreesWithDartOnRandomTrees) {
  ExpectAgreementOnRandomTrees(14, FloatingAgainstDart);
}

TEST(RigidChain, AgreesWithDartOnRandomTrees) {
  ExpectAgreementOnRandomTrees(12, FixedAgainstDart);
}

class Biped : public testing::TestWithParam<const char*> {};

TEST_P(Biped, FloatingAgreesWithDart) {
  SKIP_WITHOUT_DATA(BipedPath(GetParam()));
  const Difference worst = FloatingAgainstDart(ReadBiped(GetParam()), kStates, 7);
  EXPECT_LT(worst.acceleration, kAgreement);
  EXPECT_LT(worst.response, kAgreement);
}

TEST_P(Biped, OnAFixedBaseAgreesWithDart) {
  SKIP_WITHOUT_DATA(BipedPath(GetParam()));
  const Difference worst = FixedAgainstDart(ReadBiped(GetParam()), kStates, 8);
  EXPECT_LT(worst.acceleration, kAgreement);
  EXPECT_LT(worst.response, kAgreement);
}

INSTANTIATE_TEST_SUITE_P(FloatingChain, Biped,
                         testing::Values("berkeley_humanoid_lite_biped.urdf",
                                         "hightorque_pai_12dof.urdf"),
                         [](const auto& biped) {
                           return std::string(biped.index == 0 ? "BerkeleyHumanoidLite"
                                                               : "HighTorquePi");
                         });

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

// The chain on a floating base: laws, finite differences; floating_chain_dart_test.cc has DART.
#include "sim/world/floating_chain.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <stdexcept>

#include "sim/world/chain.h"
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

// The chain with the joints that follow others free, and nu of it: T times that of the chain.
struct Freed {
  arm::Chain chain;
  Eigen::MatrixXd T;  // of nu
  Eigen::VectorXd offset;

  explicit Freed(const arm::Chain& coupled) : chain(coupled) {
    const std::vector<arm::Coordinate> at = arm::CoordinatesOf(coupled);
    int free = 0, all = 0;
    for (const arm::Body& body : coupled.bodies) {
      free += arm::IsFree(body) ? 1 : 0;
      all += body.moves ? 1 : 0;
    }
    T = Eigen::MatrixXd::Zero(kBaseFreedom + all, kBaseFreedom + free);
    T.topLeftCorner<kBaseFreedom, kBaseFreedom>().setIdentity();
    offset = Eigen::VectorXd::Zero(all);
    Eigen::Index row = 0;
    for (std::size_t i = 0; i < at.size(); ++i) {
      chain.bodies[i].mimic.reset();
      if (at[i].joint < 0) continue;
      T(kBaseFreedom + row, kBaseFreedom + at[i].joint) = at[i].multiplier;
      offset[row++] = at[i].offset;
    }
  }
  Eigen::MatrixXd joints() const {
    return T.bottomRightCorner(T.rows() - kBaseFreedom, T.cols() - kBaseFreedom);
  }
};

// H' = T' H T and H' a' = T' H a, with a of the chain whose joints are all free.
TEST(FloatingChain, JointsThatMimicOthersMoveAsTheReducedEquationsSay) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const arm::Chain coupled = WithMimics(RandomTree(seed, 12), seed);
    const Freed freed(coupled);
    FloatingChain chain(coupled), all(freed.chain);
    ASSERT_EQ(chain.freedom(), freed.T.cols());
    ASSERT_LT(chain.freedom(), all.freedom());
    RandomStates random(seed);
    FloatingState state = random.State(chain);
    FloatingState lifted = state;
    lifted.joint_position_rad = freed.joints() * state.joint_position_rad + freed.offset;
    lifted.velocity = freed.T * state.velocity;
    const Eigen::VectorXd torque = random.Vector(all.joint_count(), 5.0);
    const std::vector<LinkForce> forces = random.Forces(chain);
    chain.SetState(state);
    all.SetState(lifted);
    Eigen::VectorXd a(chain.freedom()), b(all.freedom());
    chain.Solve(freed.joints().transpose() * torque, forces, a);
    all.Solve(torque, forces, b);
    Eigen::MatrixXd inertia(chain.freedom(), chain.freedom()), full(all.freedom(), all.freedom());
    chain.Inertia({}, inertia);
    all.Inertia({}, full);
    const Eigen::MatrixXd expected = freed.T.transpose() * full * freed.T;
    EXPECT_LT((inertia - expected).norm(), kAgreement * expected.norm()) << seed;
    const Eigen::VectorXd force = freed.T.transpose() * full * b;
    EXPECT_LT((expected * a - force).norm(), 1e-8 * force.norm()) << seed;
    EXPECT_NEAR(chain.Energy(), all.Energy(), kAgreement * std::abs(all.Energy())) << seed;

    RigidChain rigid(coupled), rigid_all(freed.chain);
    JointVector c, d;
    JointMatrix inverse, inverse_all;
    rigid.SetState(state.joint_position_rad, state.velocity.tail(chain.joint_count()));
    rigid_all.SetState(lifted.joint_position_rad, lifted.velocity.tail(all.joint_count()));
    rigid.Solve(&c, &inverse);
    rigid_all.Solve(&d, &inverse_all);
    const Eigen::MatrixXd h = inverse_all.inverse();
    const Eigen::MatrixXd reduced = freed.joints().transpose() * h * freed.joints();
    const Eigen::MatrixXd one = reduced * inverse;
    EXPECT_LT((one - Eigen::MatrixXd::Identity(one.rows(), one.cols())).norm(), 1e-8) << seed;
    const Eigen::VectorXd generalised = freed.joints().transpose() * h * d;
    EXPECT_LT((reduced * c - generalised).norm(), 1e-8 * generalised.norm()) << seed;
  }
}

// Nothing but gravity acts: dE/dt = 0, by central differences.
TEST(FloatingChain, CouplingsDoNoWork) {
  constexpr double kStep_s = 1e-5;
  for (unsigned seed = 0; seed < 10; ++seed) {
    FloatingChain chain(WithMimics(RandomTree(seed, 9), seed));
    const FloatingState state = RandomStates(seed).State(chain);
    Eigen::VectorXd a(chain.freedom());
    chain.SetState(state);
    const double energy_J = chain.Energy();
    chain.Solve(Eigen::VectorXd::Zero(chain.joint_count()), {}, a);
    const auto energy_at = [&](double time_s) {
      FloatingState moved = state;
      moved.velocity += 0.5 * time_s * a;
      Drift(time_s, &moved);
      moved.velocity = state.velocity + time_s * a;
      chain.SetState(moved);
      return chain.Energy();
    };
    const double power_W = (energy_at(kStep_s) - energy_at(-kStep_s)) / (2.0 * kStep_s);
    EXPECT_LT(std::abs(power_W), 1e-5 * std::abs(energy_J) + 1e-3) << seed;
  }
}

TEST(FloatingChain, PointsMoveAsFiniteDifferencesSay) {
  FloatingChain chain(WithMimics(RandomTree(9, 8), 9));
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
  FloatingChain chain(WithMimics(RandomTree(2, 14), 2));
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

// The chain on a floating and on a fixed base against DART, on random states of trees and bipeds.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <string>
#include <vector>

#include "sim/world/chain.h"
#include "sim/world/floating_chain.h"
#include "tests/sim/world/biped.h"
#include "tests/sim/world/dart_skeleton.h"
#include "tests/sim/world/random_tree.h"
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

}  // namespace
}  // namespace sinew::world

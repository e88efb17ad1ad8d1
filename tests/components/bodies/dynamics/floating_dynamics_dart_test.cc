// Inverse dynamics on a floating base against DART's recursion, on random states of trees and
// bipeds.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <string>

#include "components/bodies/dynamics/floating_dynamics.h"
#include "sim/world/floating_chain.h"
#include "tests/sim/world/biped.h"
#include "tests/sim/world/dart_skeleton.h"
#include "tests/sim/world/random_tree.h"
#include "tests/support/skip.h"

namespace sinew::arm {
namespace {

// Of forces, relative. Found against DART: at most 3.3e-15 (random trees), 1.8e-15 (bipeds).
constexpr double kAgreement = 1e-12;
constexpr int kStates = 2000;

// Largest relative difference of F over random states and accelerations.
double AgainstDart(const Chain& chain, int states, unsigned seed) {
  FloatingDynamics ours(chain);
  const world::FloatingChain sizes(chain);
  world::DartChain reference(chain, /*fixed_base=*/false);
  world::RandomStates random(seed);
  Eigen::VectorXd expected(ours.freedom()), force(ours.freedom());
  double worst = 0.0;
  for (int k = 0; k < states; ++k) {
    const world::FloatingState state = random.State(sizes);
    const Eigen::VectorXd acceleration = random.Vector(ours.freedom(), 20.0);
    reference.SetState(state);
    reference.Force(acceleration, expected);
    ours.Force({state.orientation, state.joint_position_rad, state.velocity, acceleration},
               ours.nominal(), force);
    worst = std::max(worst, (force - expected).norm() / expected.norm());
  }
  return worst;
}

TEST(FloatingDynamics, AgreesWithDartOnRandomTrees) {
  constexpr int kTrees = 20;
  for (unsigned seed = 1; seed <= kTrees; ++seed) {
    EXPECT_LT(AgainstDart(world::RandomTree(seed, 14), kStates / kTrees, seed), kAgreement) << seed;
  }
}

class BipedDynamics : public testing::TestWithParam<const char*> {};

TEST_P(BipedDynamics, AgreesWithDart) {
  SKIP_WITHOUT_DATA(world::BipedPath(GetParam()));
  EXPECT_LT(AgainstDart(world::ReadBiped(GetParam()), kStates, 7), kAgreement);
}

INSTANTIATE_TEST_SUITE_P(FloatingDynamics, BipedDynamics,
                         testing::Values("berkeley_humanoid_lite_biped.urdf",
                                         "hightorque_pai_12dof.urdf"),
                         [](const auto& biped) {
                           return std::string(biped.index == 0 ? "BerkeleyHumanoidLite"
                                                               : "HighTorquePi");
                         });

}  // namespace
}  // namespace sinew::arm

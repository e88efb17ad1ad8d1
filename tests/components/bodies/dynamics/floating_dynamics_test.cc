// Inverse dynamics on a floating base against the forward dynamics of sim/world (Bullet's
// articulated bodies), on random states of trees; floating_dynamics_dart_test.cc has DART's
// recursion.
#include "components/bodies/dynamics/floating_dynamics.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>
#include <string>

#include "sim/world/floating_chain.h"
#include "tests/sim/world/random_tree.h"
#include "tests/support/allocations.h"

namespace sinew::arm {
namespace {

// Of forces, relative. Found against DART: at most 3.3e-15 (random trees), 1.8e-15 (bipeds).
constexpr double kAgreement = 1e-12;

FloatingMotion MotionOf(const world::FloatingState& state, const Eigen::VectorXd& acceleration) {
  return {state.orientation, state.joint_position_rad, state.velocity, acceleration};
}

Eigen::VectorXd ForceOf(FloatingDynamics& dynamics, const FloatingMotion& motion) {
  Eigen::VectorXd force(dynamics.freedom());
  dynamics.Force(motion, dynamics.nominal(), force);
  return force;
}

// Forward dynamics and back: F are the torques and the force on the base that were put in.
TEST(FloatingDynamics, GivesBackTheForcesOfTheForwardDynamics) {
  // Found: 2e-13. The accelerations in between are larger than the forces by 1 / inertia.
  constexpr double kRoundTrip = 1e-11;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Chain chain = world::RandomTree(seed, 12);
    FloatingDynamics ours(chain);
    world::FloatingChain forward(chain);
    world::RandomStates random(seed);
    for (int k = 0; k < 20; ++k) {
      const world::FloatingState state = random.State(forward);
      const world::LinkForce push{world::kBaseBody, random.Vector(3, 0.2), random.Vector(3, 50.0)};
      Eigen::VectorXd put_in(ours.freedom()), acceleration(ours.freedom());
      const Eigen::Vector3d lever = state.orientation * push.point_m;
      put_in << lever.cross(push.force_N), push.force_N, random.Vector(ours.joints(), 20.0);
      forward.SetState(state);
      forward.Solve(put_in.tail(ours.joints()), {&push, 1}, acceleration);
      const Eigen::VectorXd force = ForceOf(ours, MotionOf(state, acceleration));
      EXPECT_LT((force - put_in).norm(), kRoundTrip * put_in.norm()) << seed;
    }
  }
}

TEST(FloatingDynamics, TheRegressorTimesTheParametersIsTheRecursion) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Chain chain = world::RandomTree(seed, 10);
    FloatingDynamics dynamics(chain);
    const world::FloatingChain sizes(chain);
    world::RandomStates random(seed);
    const FloatingMotion motion =
        MotionOf(random.State(sizes), random.Vector(dynamics.freedom(), 20.0));
    const Eigen::VectorXd nominal = ForceOf(dynamics, motion);
    const Eigen::MatrixXd Y = dynamics.Regressor(motion);
    EXPECT_LT((Y * dynamics.nominal() - nominal).norm(), kAgreement * nominal.norm());
    const Eigen::VectorXd phi = random.Vector(dynamics.parameters(), 1.0);
    Eigen::VectorXd force(dynamics.freedom());
    dynamics.Force(motion, phi, force);
    EXPECT_LT((Y * phi - force).norm(), kAgreement * force.norm());
  }
}

TEST(FloatingDynamics, AtRestTheBaseNeedsTheWeightBelowTheCentreOfMass) {
  const Chain chain = world::RandomTree(5, 9);
  FloatingDynamics dynamics(chain);
  world::FloatingChain world(chain);
  world::RandomStates random(3);
  world::FloatingState state = random.State(world);
  state.velocity.setZero();
  world.SetState(state);
  const Eigen::VectorXd force =
      ForceOf(dynamics, MotionOf(state, Eigen::VectorXd::Zero(dynamics.freedom())));
  EXPECT_NEAR(dynamics.mass_kg(), world.mass_kg(), kAgreement * world.mass_kg());
  const Eigen::Vector3d weight(0.0, 0.0, 9.81 * world.mass_kg());
  const Eigen::Vector3d moment = (world.CenterOfMass() - state.position_m).cross(weight);
  EXPECT_LT((force.segment<3>(3) - weight).norm(), kAgreement * weight.norm());
  EXPECT_LT((force.head<3>() - moment).norm(), kAgreement * weight.norm());
}

// Falling freely needs nothing.
TEST(FloatingDynamics, InFreeFallNoForceIsNeeded) {
  FloatingDynamics dynamics(world::RandomTree(5, 9));
  FloatingMotion motion = dynamics.Rest();
  motion.acceleration[5] = -9.81;
  EXPECT_EQ(ForceOf(dynamics, motion).norm(), 0.0);
}

// On a floating base a revolute joint adds seven base parameters, a prismatic one four, the base
// ten; and forces on the base alone show all of them (Ayusawa, Venture, Nakamura: Identifiability
// and identification of inertial parameters using the underactuated base-link dynamics for legged
// multibody systems, Int. J. Robotics Research 33 (2014) 446).
TEST(FloatingDynamics, BaseParametersAreTenAndSevenOrFourAJoint) {
  const Chain chain = world::RandomTree(2, 8);
  FloatingDynamics dynamics(chain);
  std::size_t expected = kParametersPerBody;
  for (const Body& body : chain.bodies) {
    if (body.moves) expected += body.prismatic ? 4 : 7;
  }
  const BaseParameters base = FindBaseParameters(dynamics);
  EXPECT_EQ(base.independent.size(), expected);
  EXPECT_EQ(base.independent.size() + base.dependent.size(),
            static_cast<std::size_t>(dynamics.parameters()));

  const world::FloatingChain sizes(chain);
  world::RandomStates random(4);
  const int states = dynamics.parameters();
  Eigen::MatrixXd of_base(kBaseFreedom * states, dynamics.parameters());
  for (int s = 0; s < states; ++s) {
    const FloatingMotion motion =
        MotionOf(random.State(sizes), random.Vector(dynamics.freedom(), 10.0));
    of_base.middleRows(kBaseFreedom * s, kBaseFreedom) =
        dynamics.Regressor(motion).topRows(kBaseFreedom);
  }
  EXPECT_EQ(BaseParametersOf(of_base).independent.size(), expected);
}

TEST(FloatingDynamics, OtherParametersWithTheSameBaseParametersNeedTheSameForces) {
  const Chain chain = world::RandomTree(6, 7);
  FloatingDynamics dynamics(chain);
  const BaseParameters base = FindBaseParameters(dynamics);
  Eigen::VectorXd other = dynamics.nominal();
  for (const int i : base.dependent) other[i] += 1.0;
  const Eigen::VectorXd change = base.Of(dynamics.nominal()) - base.Of(other);
  for (std::size_t i = 0; i < base.independent.size(); ++i) {
    other[base.independent[i]] += change[static_cast<Eigen::Index>(i)];
  }
  const world::FloatingChain sizes(chain);
  world::RandomStates random(8);
  for (int k = 0; k < 20; ++k) {
    const FloatingMotion motion =
        MotionOf(random.State(sizes), random.Vector(dynamics.freedom(), 10.0));
    const Eigen::VectorXd force = ForceOf(dynamics, motion);
    Eigen::VectorXd with_other(dynamics.freedom());
    dynamics.Force(motion, other, with_other);
    // Differences of parameters of order 1 cancel, K is known to the rank's tolerance.
    EXPECT_LT((with_other - force).norm(), 1e-8 * (1.0 + force.norm()));
  }
}

TEST(FloatingDynamics, NamesTheBasesParametersFirst) {
  const Chain chain = world::RandomTree(1, 3);
  const FloatingDynamics dynamics(chain);
  ASSERT_EQ(dynamics.parameter_names().size(), static_cast<std::size_t>(dynamics.parameters()));
  EXPECT_EQ(dynamics.parameter_names().front(), "base.m");
  EXPECT_EQ(dynamics.parameter_names()[kParametersPerBody], "link0.m");
  EXPECT_EQ(dynamics.joint_names().size(), 3u);
}

TEST(FloatingDynamics, RefusesABodyWhoseWeightIsElsewhere) {
  Chain chain = world::RandomTree(1, 3);
  chain.bodies[1].weightless = true;
  EXPECT_THROW(FloatingDynamics{chain}, std::invalid_argument);
}

TEST(FloatingDynamics, NeedsNoAllocations) {
  FloatingDynamics dynamics(world::RandomTree(2, 14));
  const FloatingMotion motion = dynamics.Rest();
  Eigen::VectorXd force(dynamics.freedom());
  const long before = test::Allocations();
  for (int k = 0; k < 10; ++k) dynamics.Force(motion, dynamics.nominal(), force);
  EXPECT_EQ(test::Allocations(), before);
}

}  // namespace
}  // namespace sinew::arm

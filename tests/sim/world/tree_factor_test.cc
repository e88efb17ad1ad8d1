// Inertia, Jacobians and their factor, against Bullet's responses and dense algebra.
#include "sim/world/tree_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <stdexcept>

#include "components/bodies/links/fixed_links.h"
#include "sim/world/floating_chain.h"
#include "tests/sim/world/random_tree.h"
#include "tests/support/allocations.h"

namespace sinew::world {
namespace {

constexpr int kTrees = 20;

// Odd seeds: some joints follow others.
arm::Chain Tree(unsigned seed) {
  const arm::Chain tree = RandomTree(seed, 12);
  return seed % 2 == 0 ? tree : WithMimics(tree, seed);
}

TEST(TreeFactor, TheInertiaIsTheInverseOfTheResponsesToForces) {
  for (unsigned seed = 0; seed < kTrees; ++seed) {
    FloatingChain chain(Tree(seed));
    const FloatingState state = RandomStates(seed).State(chain);
    chain.SetState(state);
    Eigen::VectorXd acceleration(chain.freedom());
    chain.Solve(Eigen::VectorXd::Zero(chain.joint_count()), {}, acceleration);
    Eigen::MatrixXd responses(chain.freedom(), chain.freedom()), inertia = responses;
    chain.Responses(responses);
    chain.Inertia({}, inertia);
    const Eigen::MatrixXd one = inertia * responses;
    EXPECT_LT((one - Eigen::MatrixXd::Identity(one.rows(), one.cols())).norm(), 1e-9) << seed;
    // Kinetic energy.
    FloatingState moving = state;
    FloatingChain weightless(Tree(seed), Eigen::Vector3d::Zero());
    weightless.SetState(moving);
    const double energy_J = 0.5 * moving.velocity.dot(inertia * moving.velocity);
    EXPECT_NEAR(energy_J, weightless.Energy(), 1e-12 * energy_J);
  }
}

TEST(TreeFactor, AJacobianGivesTheVelocityOfAPoint) {
  FloatingChain chain(Tree(7));
  RandomStates random(7);
  const FloatingState state = random.State(chain);
  chain.SetState(state);
  Eigen::Matrix3Xd jacobian(3, chain.freedom());
  for (int body = kBaseBody; body < chain.body_count(); ++body) {
    const Eigen::Vector3d point_m = random.Vector(3, 0.2);
    chain.Jacobian(body, point_m, jacobian);
    const Eigen::Vector3d velocity = chain.Point(body, point_m).velocity_m_s;
    EXPECT_LT((jacobian * state.velocity - velocity).norm(), 1e-12 * velocity.norm()) << body;
  }
}

TEST(TreeFactor, AnAddedPointInertiaActsOnItsPoint) {
  FloatingChain chain(Tree(9));
  RandomStates random(9);
  chain.SetState(random.State(chain));
  const PointInertia at{
      .body = chain.body_count() - 1, .point_m = {0.1, -0.2, 0.3}, .mass_kg = {1.0, 2.0, 3.0}};
  Eigen::MatrixXd without(chain.freedom(), chain.freedom()), with = without;
  chain.Inertia({}, without);
  chain.Inertia({&at, 1}, with);
  Eigen::Matrix3Xd jacobian(3, chain.freedom());
  chain.Jacobian(at.body, at.point_m, jacobian);
  const Eigen::MatrixXd expected =
      without + jacobian.transpose() * at.mass_kg.asDiagonal() * jacobian;
  EXPECT_LT((with - expected).norm(), 1e-13 * expected.norm());
}

TEST(TreeFactor, SolvesAndInvertsAsDenseAlgebraDoes) {
  for (unsigned seed = 0; seed < kTrees; ++seed) {
    FloatingChain chain(Tree(seed));
    RandomStates random(seed);
    chain.SetState(random.State(chain));
    Eigen::MatrixXd inertia(chain.freedom(), chain.freedom());
    chain.Inertia({}, inertia);
    TreeFactor factor(chain.parents());
    ASSERT_TRUE(factor.Factor(inertia));
    const Eigen::MatrixXd dense = inertia.inverse();
    const Eigen::VectorXd right = random.Vector(chain.freedom(), 1.0);
    Eigen::VectorXd x = right;
    const long before = test::Allocations();
    factor.Solve(x);
    EXPECT_EQ(test::Allocations(), before);
    EXPECT_LT((inertia * x - right).norm(), 1e-11 * inertia.norm() * x.norm()) << seed;
    Eigen::MatrixXd joints(chain.joint_count(), chain.joint_count());
    factor.InverseFrom(kBaseFreedom, joints);
    const Eigen::MatrixXd expected =
        dense.bottomRightCorner(chain.joint_count(), chain.joint_count());
    EXPECT_LT((joints - expected).norm(), 1e-9 * expected.norm()) << seed;
  }
}

TEST(TreeFactor, RefusesParentsThatComeLaterAndMatricesThatAreNotPositive) {
  EXPECT_THROW(TreeFactor({-1, 1}), std::invalid_argument);
  EXPECT_THROW(TreeFactor({-2}), std::invalid_argument);
  TreeFactor factor({-1, 0});
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1.0, 2.0, 2.0, 1.0;
  EXPECT_FALSE(factor.Factor(matrix));
  matrix << std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0, 1.0;
  EXPECT_FALSE(factor.Factor(matrix));
  matrix << 1.0, 0.0, 0.0, std::numeric_limits<double>::infinity();
  EXPECT_FALSE(factor.Factor(matrix));
}

// Random trees have fixed links; the merged chain moves as the whole one does.
TEST(MergeFixedLinks, GivesTheSameMotionWithFewerBodies) {
  for (unsigned seed = 0; seed < kTrees; ++seed) {
    const arm::Chain whole = RandomTree(seed, 12);
    const arm::MergedChain merged = arm::MergeFixedLinks(whole);
    ASSERT_EQ(merged.frames.size(), whole.bodies.size() + 1);
    FloatingChain a(whole), b(merged.chain);
    ASSERT_EQ(b.body_count(), b.joint_count());
    ASSERT_LT(b.body_count(), a.body_count());
    EXPECT_NEAR(a.mass_kg(), b.mass_kg(), 1e-12 * a.mass_kg());
    RandomStates random(seed);
    const FloatingState state = random.State(a);
    const Eigen::VectorXd torque = random.Vector(a.joint_count(), 20.0);
    std::vector<LinkForce> forces = random.Forces(a);
    a.SetState(state);
    b.SetState(state);
    Eigen::VectorXd of_whole(a.freedom()), of_merged(b.freedom());
    a.Solve(torque, forces, of_whole);
    for (LinkForce& force : forces) {
      const arm::LinkFrame& frame = merged.frames[static_cast<std::size_t>(force.body + 1)];
      force.body = frame.body;
      force.point_m = frame.body_from_link * force.point_m;
    }
    b.Solve(torque, forces, of_merged);
    EXPECT_LT((of_whole - of_merged).norm(), 1e-9 * of_whole.norm()) << seed;
    for (int body = 0; body < a.body_count(); ++body) {
      const arm::LinkFrame* frame =
          arm::FindLink(merged, whole.bodies[static_cast<std::size_t>(body)].link_name);
      ASSERT_NE(frame, nullptr);
      const Eigen::Matrix4d pose = (b.Pose(frame->body) * frame->body_from_link).matrix();
      EXPECT_LT((pose - a.Pose(body).matrix()).norm(), 1e-12);
    }
  }
  EXPECT_EQ(arm::FindLink(arm::MergeFixedLinks(RandomTree(1, 3)), "no such link"), nullptr);
}

TEST(MergeFixedLinks, APointMassIsThatOfALinkFixedThere) {
  arm::Chain whole = RandomTree(3, 5);
  arm::Body weight;
  weight.link_name = weight.joint_name = "weight";
  weight.parent = 2;
  weight.mass_kg = 2.0;
  weight.parent_from_joint.translate(Eigen::Vector3d(0.1, 0.2, -0.3));
  arm::MergedChain merged = arm::MergeFixedLinks(whole);
  whole.bodies.push_back(weight);
  const arm::MergedChain expected = arm::MergeFixedLinks(whole);
  const arm::LinkFrame& on = merged.frames[3];
  ASSERT_GE(on.body, 0);
  arm::Body& body = merged.chain.bodies[static_cast<std::size_t>(on.body)];
  arm::AddPointMass(2.0, on.body_from_link * Eigen::Vector3d(0.1, 0.2, -0.3), &body);
  const arm::Body& same = expected.chain.bodies[static_cast<std::size_t>(on.body)];
  EXPECT_NEAR(body.mass_kg, same.mass_kg, 1e-15);
  EXPECT_LT((body.com_m - same.com_m).norm(), 1e-15);
  EXPECT_LT((body.inertia_kg_m2 - same.inertia_kg_m2).norm(), 1e-14);
}

TEST(MergeFixedLinks, RefusesALinkOfWhichOnlyAPartHasWeight) {
  arm::Chain chain = RandomTree(3, 5);
  for (arm::Body& body : chain.bodies) {
    if (body.moves) continue;
    body.weightless = true;
    EXPECT_THROW(arm::MergeFixedLinks(chain), std::invalid_argument);
    return;
  }
  FAIL() << "the tree has no fixed link";
}

}  // namespace
}  // namespace sinew::world

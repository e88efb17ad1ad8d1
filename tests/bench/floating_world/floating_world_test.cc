// Laws of motion of the robot on a floating base: energy, angular momentum, contact, standing.
#include "bench/floating_world/floating_world.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include "tests/sim/world/biped.h"
#include "tests/sim/world/random_tree.h"
#include "tests/support/allocations.h"
#include "tests/support/skip.h"

namespace sinew::world {
namespace {

constexpr double kEarth_m_s2 = 9.81;

// Revolute joints only: a slide without a stop leaves.
FloatingWorldConfig FlyingTree(double substep_s) {
  FloatingWorldConfig config;
  config.chain = RandomTree(11, 8);
  for (arm::Body& body : config.chain.bodies) body.prismatic = false;
  config.substep_s = substep_s;
  return config;
}

FloatingState FlyingState(const FloatingWorld& world) {
  return RandomStates(3).State(world.chain());
}

struct Drifts {
  double energy_J = 0.0;
  double momentum = 0.0;  // relative
};

// Largest deviations over a second of flight without torques.
Drifts Fly(double substep_s) {
  FloatingWorld world(FlyingTree(substep_s));
  world.Reset(FlyingState(world));
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(world.chain().joint_count());
  FloatingChain chain(FlyingTree(substep_s).chain);
  chain.SetState(world.state());
  const double energy_J = chain.Energy();
  const Eigen::Vector3d momentum = chain.AngularMomentum();
  Drifts worst;
  const long steps = std::lround(1.0 / substep_s);
  for (long k = 0; k < steps; ++k) {
    EXPECT_EQ(world.Step(none), StepStatus::kOk);
    if (k % 10 != 9) continue;
    chain.SetState(world.state());
    worst.energy_J = std::max(worst.energy_J, std::abs(chain.Energy() - energy_J));
    worst.momentum =
        std::max(worst.momentum, (chain.AngularMomentum() - momentum).norm() / momentum.norm());
  }
  return worst;
}

TEST(FloatingWorld, EnergyAndAngularMomentumOfFlightConvergeWithTheSquareOfTheStep) {
  const Drifts coarse = Fly(kFloatingSubstep_s), fine = Fly(0.5 * kFloatingSubstep_s);
  // Three times what was found: 3.7e-6 J, and 1.0e-7 of the momentum.
  EXPECT_LT(coarse.energy_J, 1.2e-5);
  EXPECT_LT(coarse.momentum, 3e-7);
  // 4 for the second order; rounding is ten thousand times smaller.
  EXPECT_NEAR(coarse.energy_J / fine.energy_J, 4.0, 0.4);
  EXPECT_NEAR(coarse.momentum / fine.momentum, 4.0, 0.4);
}

TEST(FloatingWorld, TheCenterOfMassOfAFlyingTreeFollowsAParabola) {
  FloatingWorld world(FlyingTree(kFloatingSubstep_s));
  const FloatingState begin = FlyingState(world);
  world.Reset(begin);
  FloatingChain chain(FlyingTree(kFloatingSubstep_s).chain);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(chain.joint_count());
  chain.SetState(begin);
  const Eigen::Vector3d start = chain.CenterOfMass();
  FloatingState moved = begin;
  constexpr double kTiny_s = 1e-7;
  Drift(kTiny_s, &moved);
  chain.SetState(moved);
  const Eigen::Vector3d velocity = (chain.CenterOfMass() - start) / kTiny_s;
  constexpr int kSteps = 5000;
  for (int k = 0; k < kSteps; ++k) EXPECT_EQ(world.Step(none), StepStatus::kOk);
  const double time_s = kSteps * kFloatingSubstep_s;
  chain.SetState(world.state());
  const Eigen::Vector3d expected =
      start + time_s * velocity - 0.5 * kEarth_m_s2 * time_s * time_s * Eigen::Vector3d::UnitZ();
  EXPECT_LT((chain.CenterOfMass() - expected).norm(), 1e-5);
}

// A flat box of 2 kg on four points; no joints.
FloatingWorldConfig Box() {
  FloatingWorldConfig config;
  config.chain.base.link_name = "box";
  config.chain.base.mass_kg = 2.0;
  config.chain.base.com_m = {0.01, -0.005, 0.02};
  config.chain.base.inertia_kg_m2 = Eigen::Vector3d(0.004, 0.006, 0.009).asDiagonal();
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.06, 0.06}) {
      config.contacts.push_back({"corner", kBaseBody, {x, y, 0.0}});
    }
  }
  config.ground.friction = 0.6;
  config.ground.static_load_N = 2.0 * kEarth_m_s2 / 4.0;
  config.base_from_imu.translate(Eigen::Vector3d(0.03, 0.02, 0.01));
  config.base_from_imu.rotate(Eigen::AngleAxisd(0.5 * M_PI, Eigen::Vector3d::UnitX()));
  return config;
}

double NormalSum(const FloatingWorld& world) {
  double sum = 0.0;
  for (const ContactForce& force : world.contact_forces()) sum += force.normal_N;
  return sum;
}

// Steps without torques; the pushes follow their points.
void Settle(FloatingWorld* world, double time_s, std::span<const LinkForce> pushes = {}) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(world->chain().joint_count());
  const long steps = std::lround(time_s / world->substep_s());
  for (long k = 0; k < steps; ++k) EXPECT_EQ(world->Step(none, pushes), StepStatus::kOk);
}

FloatingState Dropped(const FloatingWorld& world) {
  FloatingState state = world.chain().Rest();
  state.position_m.z() = 0.05;
  state.orientation = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1.0, 2.0, 0.5).normalized());
  return state;
}

TEST(FloatingWorld, ADroppedBoxComesToRestOnItsWeight) {
  FloatingWorld world(Box());
  world.Reset(Dropped(world));
  Settle(&world, 3.0);
  const double weight_N = 2.0 * kEarth_m_s2;
  EXPECT_NEAR(NormalSum(world), weight_N, 1e-3 * weight_N);
  EXPECT_LT(world.state().velocity.norm(), 1e-6);
  // The centre of mass is nearer to two of the corners.
  EXPECT_NEAR(-world.state().position_m.z(), Box().ground.static_sink_m, 2e-4);
  // The IMU is turned by 90 degrees about x: up is its y.
  const ImuReading& imu = world.imu();
  const Eigen::Vector3d up = world.state().orientation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d expected(up.x(), up.z(), -up.y());
  EXPECT_LT((imu.specific_force_m_s2 - kEarth_m_s2 * expected).norm(), 1e-5);
  EXPECT_LT(imu.angular_velocity_rad_s.norm(), 1e-6);
}

// A body that falls and spins about a principal axis: the IMU, beside the axis, feels the
// centripetal acceleration alone.
TEST(FloatingWorld, TheImuOfASpinningBodyInFreeFallFeelsItsTurning) {
  FloatingWorldConfig config = Box();
  config.chain.base.com_m.setZero();
  config.contacts.clear();
  FloatingWorld world(config);
  FloatingState state = world.chain().Rest();
  state.orientation = Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY());
  const double rate_rad_s = 5.0;
  state.velocity.head<3>() = state.orientation * Eigen::Vector3d(0.0, 0.0, rate_rad_s);
  world.Reset(state);
  Settle(&world, 0.3);
  // At (0.03, 0.02, 0.01) of the body; the IMU's x, y, z are the body's x, z, -y.
  const Eigen::Vector3d in_body = -rate_rad_s * rate_rad_s * Eigen::Vector3d(0.03, 0.02, 0.0);
  const Eigen::Vector3d expected(in_body.x(), in_body.z(), -in_body.y());
  // The midpoint rule's errors, (w h)^2 a step.
  EXPECT_LT((world.imu().specific_force_m_s2 - expected).norm(), 1e-6);
  EXPECT_LT((world.imu().angular_velocity_rad_s - Eigen::Vector3d(0.0, rate_rad_s, 0.0)).norm(),
            1e-6);
}

LinkForce Push(double force_N) { return {kBaseBody, {0.0, 0.0, 0.0}, {force_N, 0.0, 0.0}}; }

TEST(FloatingWorld, APushBelowTheLimitOfFrictionDoesNotMakeTheBoxCreep) {
  FloatingWorld world(Box());
  world.Reset(Dropped(world));
  const LinkForce push = Push(0.9 * 0.6 * 2.0 * kEarth_m_s2);
  Settle(&world, 2.0);
  Settle(&world, 1.0, {&push, 1});  // the bristles give way elastically
  const Eigen::Vector3d before = world.state().position_m;
  Settle(&world, 10.0, {&push, 1});
  const double creep_m = (world.state().position_m - before).norm();
  EXPECT_LT(creep_m, 1e-6);
}

// What is left of the heave: 1e-3 of gravity.
constexpr double kSlide_m_s2 = 0.01;

TEST(FloatingWorld, APushAboveTheLimitOfFrictionMovesTheBoxAndFrictionStopsIt) {
  FloatingWorldConfig config = Box();
  config.chain.base.com_m = {0.0, 0.0, 0.02};  // so that the box does not turn
  FloatingWorld world(config);
  world.Reset(Dropped(world));
  const double limit_N = 0.6 * 2.0 * kEarth_m_s2;
  const LinkForce push = Push(1.5 * limit_N);
  Settle(&world, 2.0);
  // Steps of the force make the box heave and nod on its corners: until that has died away the
  // normal force is not the weight.
  Settle(&world, 0.5, {&push, 1});
  double speed = world.state().velocity[3];
  Settle(&world, 0.5, {&push, 1});
  // (F - mu m g) / m
  EXPECT_NEAR((world.state().velocity[3] - speed) / 0.5, 0.5 * 0.6 * kEarth_m_s2, kSlide_m_s2);
  Settle(&world, 0.2);
  speed = world.state().velocity[3];
  Settle(&world, 0.2);
  EXPECT_NEAR((speed - world.state().velocity[3]) / 0.2, 0.6 * kEarth_m_s2, kSlide_m_s2);
  for (const ContactForce& force : world.contact_forces()) {
    EXPECT_NEAR(force.tangential_N.norm(), 0.6 * force.normal_N, 1e-9);
  }
}

// A foot of two segments, hinged by an elastic joint that is bent by the load.
TEST(FloatingWorld, TheElasticJointOfAFootCarriesItsLoad) {
  FloatingWorldConfig config = Box();
  arm::Body toe;
  toe.link_name = toe.joint_name = "toe";
  toe.moves = true;
  toe.axis = Eigen::Vector3d::UnitY();
  toe.parent_from_joint.translate(Eigen::Vector3d(0.1, 0.0, 0.0));
  toe.mass_kg = 0.05;
  toe.com_m = {0.02, 0.0, 0.0};
  toe.inertia_kg_m2 = 1e-5 * Eigen::Matrix3d::Identity();
  config.chain.bodies = {toe};
  // Two sensors under each segment.
  config.contacts = {{"heel", kBaseBody, {-0.1, -0.06, 0.0}},
                     {"heel", kBaseBody, {-0.1, 0.06, 0.0}},
                     {"toe", 0, {0.04, -0.06, 0.0}},
                     {"toe", 0, {0.04, 0.06, 0.0}}};
  config.elastic_joints = {{.joint = 0, .stiffness_Nm_rad = 20.0, .damping_Nm_s_rad = 0.05}};
  FloatingWorld world(config);
  FloatingState state = world.chain().Rest();
  state.position_m.z() = 0.01;
  world.Reset(state);
  Settle(&world, 3.0);
  EXPECT_NEAR(NormalSum(world), 2.05 * kEarth_m_s2, 1e-3 * 2.05 * kEarth_m_s2);
  EXPECT_LT(world.state().velocity.norm(), 1e-6);
  // Moments about the toe's axis: sensors at 0.04 m, the toe's weight at 0.02 m, along the toe.
  const double q = world.state().joint_position_rad[0];
  const Eigen::Matrix3d toe_to_world = world.chain().Pose(0).linear();
  double moment_Nm = -0.02 * toe_to_world(0, 0) * 0.05 * kEarth_m_s2;
  for (const std::size_t k : {2u, 3u}) {
    const ContactForce& force = world.contact_forces()[k];
    const Eigen::Vector3d arm = toe_to_world * Eigen::Vector3d(0.04, 0.0, 0.0);
    moment_Nm += arm.x() * force.normal_N - arm.z() * force.tangential_N.x();
  }
  EXPECT_LT(q, -1e-3);
  // About +y, upward forces ahead of the axis turn back.
  EXPECT_NEAR(20.0 * -q, moment_Nm, 1e-4);
}

void StandForFiveSeconds(const StandingBiped& biped) {
  FloatingWorld world(biped.config);
  world.Reset(biped.state);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(world.chain().joint_count());
  const long steps = std::lround(5.0 / world.substep_s());
  for (long k = 0; k < steps; ++k) {
    HoldPosture(biped, world.state(), &torque);
    ASSERT_EQ(world.Step(torque), StepStatus::kOk) << k;
  }
  const double weight_N = world.chain().mass_kg() * kEarth_m_s2;
  EXPECT_NEAR(NormalSum(world), weight_N, 1e-3 * weight_N);
  for (const ContactForce& force : world.contact_forces()) EXPECT_GT(force.normal_N, 1.0);
  EXPECT_LT(world.state().velocity.norm(), 1e-4);
  EXPECT_NEAR(world.state().position_m.z(), biped.state.position_m.z(), 0.02);
  EXPECT_LT(world.state().orientation.angularDistance(Eigen::Quaterniond::Identity()), 0.1);
  EXPECT_NEAR(world.imu().specific_force_m_s2.norm(), kEarth_m_s2, 1e-3);
}

TEST(FloatingWorld, ABipedStandsOnItsFeetAndTheSensorsCarryItsWeight) {
  SKIP_WITHOUT_DATA(BipedPath(kBerkeleyBiped));
  StandForFiveSeconds(MakeStandingBiped());
}

TEST(FloatingWorld, ABipedStandsOnFeetWithElasticToes) {
  SKIP_WITHOUT_DATA(BipedPath(kBerkeleyBiped));
  const StandingBiped biped = MakeStandingBiped(/*toes=*/true);
  EXPECT_EQ(biped.posture_rad.size(), 14);
  EXPECT_EQ(biped.config.contacts.size(), 8u);
  StandForFiveSeconds(biped);
}

std::vector<double> Trace(const FloatingWorldConfig& config) {
  FloatingWorld world(config);
  world.Reset(Dropped(world));
  const LinkForce push = Push(20.0);
  std::vector<double> trace;
  for (int k = 0; k < 5000; ++k) {
    EXPECT_EQ(world.Step(Eigen::VectorXd(), {&push, 1}), StepStatus::kOk);
    const FloatingState& state = world.state();
    for (int i = 0; i < 3; ++i) trace.push_back(state.position_m[i]);
    for (int i = 0; i < 4; ++i) trace.push_back(state.orientation.coeffs()[i]);
    for (int i = 0; i < 6; ++i) trace.push_back(state.velocity[i]);
    for (const ContactForce& force : world.contact_forces()) trace.push_back(force.normal_N);
  }
  return trace;
}

TEST(FloatingWorld, TwoRunsAreEqualToTheBit) {
  const std::vector<double> first = Trace(Box()), second = Trace(Box());
  ASSERT_EQ(first.size(), second.size());
  EXPECT_EQ(std::memcmp(first.data(), second.data(), first.size() * sizeof(double)), 0);
}

TEST(FloatingWorld, AStepAllocatesNothing) {
  FloatingWorldConfig config = FlyingTree(kFloatingSubstep_s);
  config.contacts = {{"a", 0, {0.0, 0.0, 0.0}}, {"b", kBaseBody, {0.1, 0.0, 0.0}}};
  config.elastic_joints = {{.joint = 1, .stiffness_Nm_rad = 5.0}};
  FloatingWorld world(config);
  world.Reset(FlyingState(world));
  const Eigen::VectorXd torque = Eigen::VectorXd::Constant(world.chain().joint_count(), 0.1);
  const LinkForce push = Push(1.0);
  const long before = test::Allocations();
  for (int k = 0; k < 100; ++k) EXPECT_EQ(world.Step(torque, {&push, 1}), StepStatus::kOk);
  EXPECT_EQ(test::Allocations(), before);
}

TEST(FloatingWorld, BadInputIsTakenAsZeroAndReported) {
  const FloatingWorldConfig config = FlyingTree(kFloatingSubstep_s);
  FloatingWorld world(config), reference(config);
  const FloatingState state = FlyingState(world);
  world.Reset(state);
  reference.Reset(state);
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(world.chain().joint_count());
  EXPECT_EQ(reference.Step(torque), StepStatus::kOk);
  torque[1] = std::numeric_limits<double>::quiet_NaN();
  const std::vector<LinkForce> pushes = {
      {99, Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones()},
      {0, Eigen::Vector3d::Zero(),
       Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity())}};
  EXPECT_EQ(world.Step(torque, pushes), StepStatus::kBadInput);
  EXPECT_EQ(world.state().velocity, reference.state().velocity);
  EXPECT_EQ(world.Step(Eigen::VectorXd::Zero(1)), StepStatus::kBadInput);
}

TEST(FloatingWorld, AStateThatWouldNotBeFiniteIsNotTaken) {
  FloatingWorld world(FlyingTree(kFloatingSubstep_s));
  const FloatingState state = FlyingState(world);
  world.Reset(state);
  const Eigen::VectorXd torque =
      Eigen::VectorXd::Constant(world.chain().joint_count(), std::numeric_limits<double>::max());
  EXPECT_EQ(world.Step(torque), StepStatus::kDiverged);
  EXPECT_EQ(world.state().velocity, state.velocity);
}

TEST(FloatingWorld, RefusesWhatIsNotThere) {
  const auto refuses = [](const FloatingWorldConfig& bad) {
    EXPECT_THROW(FloatingWorld{bad}, std::invalid_argument);
  };
  FloatingWorldConfig bad = Box();
  bad.contacts.front().body = 0;
  refuses(bad);
  bad = Box();
  bad.contacts.front().point_m.x() = std::nan("");
  refuses(bad);
  bad = Box();
  bad.elastic_joints = {{.joint = 0, .stiffness_Nm_rad = 1.0}};
  refuses(bad);
  bad = FlyingTree(kFloatingSubstep_s);
  bad.elastic_joints = {{.joint = 0, .stiffness_Nm_rad = -1.0}};
  refuses(bad);
  bad = Box();
  bad.substep_s = 0.0;
  refuses(bad);
  bad = Box();
  bad.ground.friction = -1.0;
  refuses(bad);
  FloatingWorld world(Box());
  FloatingState state = world.chain().Rest();
  state.velocity = Eigen::VectorXd::Zero(3);
  EXPECT_THROW(world.Reset(state), std::invalid_argument);
  state = world.chain().Rest();
  state.position_m.x() = std::nan("");
  EXPECT_THROW(world.Reset(state), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::world

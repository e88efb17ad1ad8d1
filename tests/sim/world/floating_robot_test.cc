// The robot on a floating base with actuated joints: energy, standing, friction, rotors, payload,
// sensors.
#include "sim/world/floating_robot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "tests/sim/world/robot.h"
#include "tests/support/allocations.h"
#include "tests/support/skip.h"

namespace sinew::world {
namespace {

using ::testing::HasSubstr;

constexpr double kCycle_s = 2e-3;  // of the controller
constexpr double kWeightShare = 1e-3;
constexpr double kSettled_s = 10.0;  // ten time constants of rocking

double FeetSum(const FloatingRobot& robot) {
  const auto& forces = robot.body_sensors()->foot_force_N;
  return std::accumulate(forces.begin(), forces.end(), 0.0);
}

void Simulate(FloatingRobot* robot, const provider::PlantCommand& command, double time_s) {
  provider::PlantSensors sensors;
  const long cycles = std::lround(time_s / kCycle_s);
  for (long k = 0; k < cycles; ++k) {
    robot->Step(command, kCycle_s, &sensors);
    ASSERT_FALSE(sensors.fault) << k << ": " << sensors.message;
  }
}

double TotalEnergy(const FloatingRobot& robot) {
  const arm::Chain& merged = robot.links().chain;
  FloatingChain chain(merged);
  chain.SetState(robot.state());
  double energy_J = chain.Energy();
  for (int c = 0; c < chain.joint_count(); ++c) {
    const auto& passive = merged.bodies[static_cast<std::size_t>(c)].passive;
    const double q = robot.state().joint_position_rad[c];
    const double v = robot.state().velocity[kBaseFreedom + c];
    energy_J += passive ? 0.5 * passive->stiffness_Nm_rad * q * q : 0.5 * 0.05 * v * v;
  }
  return energy_J;
}

// Largest deviation of the energy in a second, after torques and a push of 50 ms.
double EnergyDrift(double substep_s) {
  FloatingRobot robot(Flying(substep_s));
  provider::PlantSensors sensors;
  provider::PlantCommand command;
  for (int j = 0; j < robot.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    command.mode[at] = types::ControlMode::kTorque;
    command.motor_torque_Nm[at] = 0.05 * std::sin(1.0 + j);
  }
  robot.DisturbBody(
      {.push_link = "torso", .push_force_N = {60.0, -40.0, 20.0}, .push_m = {0.0, 0.1, 0.1}});
  for (int k = 0; k < 25; ++k) robot.Step(command, kCycle_s, &sensors);
  robot.DisturbBody({});
  robot.Step({}, kCycle_s, &sensors);
  const double energy_J = TotalEnergy(robot);
  double worst_J = 0.0;
  for (int k = 0; k < 500; ++k) {
    robot.Step({}, kCycle_s, &sensors);
    worst_J = std::max(worst_J, std::abs(TotalEnergy(robot) - energy_J));
  }
  EXPECT_FALSE(sensors.fault);
  return worst_J;
}

TEST(FloatingRobot, TheEnergyOfFlightConvergesWithTheSquareOfTheStep) {
  const double coarse_J = EnergyDrift(kRobotSubstep_s), fine_J = EnergyDrift(0.5 * kRobotSubstep_s);
  EXPECT_LT(coarse_J, 1.5e-4);  // three times what was found, 5.1e-5 J
  EXPECT_NEAR(coarse_J / fine_J, 4.0, 0.6);
}

TEST(FloatingRobot, ASquattingBipedStandsAndItsForceSensorsCarryItsWeight) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const double weight_N = 17.1 * 9.81;
  EXPECT_NEAR(robot.chain().mass_kg(), 17.1, 1e-9);
  EXPECT_NEAR(FeetSum(robot), weight_N, 1e-9 * weight_N);  // at the start
  Simulate(&robot, HoldStart(config), kSettled_s);
  EXPECT_NEAR(FeetSum(robot), weight_N, kWeightShare * weight_N);
  EXPECT_LT(robot.state().velocity.norm(), 1e-3);
  for (const double force_N : robot.body_sensors()->foot_force_N) EXPECT_GT(force_N, 1.0);
  for (const bool valid : robot.body_sensors()->foot_valid) EXPECT_TRUE(valid);
  EXPECT_LT(robot.state().orientation.angularDistance(Eigen::Quaterniond::Identity()), 0.1);
  // The truth is the same robot.
  const provider::BodyTruth& truth = *robot.body_truth();
  EXPECT_EQ(truth.position_m[2], robot.state().position_m.z());
  double truth_N = 0.0;
  for (const auto& force : truth.contact_force_N) truth_N += force[2];
  EXPECT_EQ(truth_N, FeetSum(robot));
}

TEST(FloatingRobot, TheImuOfAStandingRobotFeelsGravity) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const provider::BodySensors& imu = *robot.body_sensors();
  EXPECT_TRUE(imu.imu_valid);
  EXPECT_NEAR(imu.acceleration_m_s2[2], 9.81, 1e-12);  // at the start: at rest
  Simulate(&robot, HoldStart(config), kSettled_s);
  const Eigen::Quaterniond& q = robot.state().orientation;
  const Eigen::Vector3d expected = q.conjugate() * Eigen::Vector3d(0.0, 0.0, 9.81);
  for (int k = 0; k < 3; ++k) {
    const auto at = static_cast<std::size_t>(k);
    EXPECT_NEAR(imu.acceleration_m_s2[at], expected[k], 5e-3);
    EXPECT_NEAR(imu.angular_velocity_rad_s[at], 0.0, 1e-3);
  }
  EXPECT_NEAR(std::abs(imu.orientation_wxyz[0]), std::abs(q.w()), 1e-12);
}

// Forces on the contacts give the base's motion: the momentum of a step is that of what the sensors
// read, in a landing as well.
TEST(FloatingRobot, TheForceSensorsReadWhatChangesTheMomentum) {
  FloatingRobotConfig config = SquattingBiped();
  config.base_height_m = FloatingRobot(config).state().position_m.z() + 0.02;
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  FloatingChain chain(robot.links().chain);
  const auto rise_m = [&] {
    chain.SetState(robot.state());
    return chain.CenterOfMass().z();
  };
  provider::PlantSensors sensors;
  double largest_N = 0.0;
  const double h = kRobotSubstep_s;
  double before_m = rise_m();
  robot.Step(command, h, &sensors);
  double now_m = rise_m();
  for (int k = 0; k < 1200; ++k) {
    const double force_N = FeetSum(robot);  // of the step before
    robot.Step(command, h, &sensors);
    const double after_m = rise_m();
    // Second difference: acceleration over the two half steps about `now`, with the mean of the two
    // kicks' forces.
    const double acceleration = (after_m - 2.0 * now_m + before_m) / (h * h);
    const double mean_N = 0.5 * (force_N + FeetSum(robot));
    largest_N = std::max(largest_N, mean_N);
    ASSERT_NEAR(17.1 * (acceleration + 9.81), mean_N, 2.0) << k;
    before_m = now_m;
    now_m = after_m;
  }
  EXPECT_GT(largest_N, 300.0);  // it did land
}

TEST(FloatingRobot, JointsThatFrictionHoldsStandExactlyStill) {
  const FloatingRobotConfig config =
      SquattingBiped({.rotor_inertia_kg_m2 = 0.05, .coulomb_Nm = 200.0});
  FloatingRobot robot(config);
  Simulate(&robot, {}, kSettled_s);  // motors off
  const Eigen::VectorXd& q = robot.state().joint_position_rad;
  for (std::size_t j = 0; j < config.joints.size(); ++j) {
    const int body = arm::FindJoint(robot.links().chain, config.model.joints[j].name);
    EXPECT_EQ(q[body], config.joints[j].position_rad) << j;
  }
  EXPECT_NEAR(FeetSum(robot), 17.1 * 9.81, kWeightShare * 17.1 * 9.81);
}

// At the sole, so that the robot does not tip; friction carries 0.8 of the foot's 84 N.
TEST(FloatingRobot, FeetDoNotCreepUnderAPushBelowTheLimitOfFriction) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  robot.DisturbBody(
      {.push_link = "left_sole", .push_force_N = {0.0, 50.0, 0.0}, .push_m = {0.0, 0.0, 0.01}});
  Simulate(&robot, command, kSettled_s);
  const auto sole_m = [&] {
    const arm::LinkFrame& sole = *arm::FindLink(robot.links(), "left_sole");
    return robot.chain().Point(sole.body, sole.body_from_link.translation()).position_m;
  };
  const Eigen::Vector3d before = sole_m();
  Simulate(&robot, command, kSettled_s);
  EXPECT_LT((sole_m() - before).norm(), 1e-5);
  double along_N = 0.0;
  for (const auto& force : robot.body_truth()->contact_force_N) along_N += force[1];
  EXPECT_NEAR(along_N, -50.0, 0.05);
}

TEST(FloatingRobot, APayloadOfFourKilogramsIsCarriedByTheFeet) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  Simulate(&robot, command, kSettled_s);
  const double before_N = FeetSum(robot);
  robot.DisturbBody({.payload_link = "torso", .payload_kg = 4.0, .payload_m = {0.0, 0.0, 0.05}});
  EXPECT_NEAR(robot.chain().mass_kg(), 21.1, 1e-9);
  Simulate(&robot, command, kSettled_s);
  EXPECT_NEAR(FeetSum(robot) - before_N, 4.0 * 9.81, kWeightShare * 4.0 * 9.81);
  // Reset takes it off.
  provider::PlantSensors sensors;
  robot.Reset(&sensors);
  EXPECT_NEAR(robot.chain().mass_kg(), 17.1, 1e-9);
  EXPECT_NEAR(FeetSum(robot), 17.1 * 9.81, 1e-9 * 17.1 * 9.81);
}

TEST(FloatingRobot, APayloadHasInertia) {
  provider::PlantSensors sensors;
  const auto falls_m_s = [&](double payload_kg) {
    FloatingRobot robot(Flying(1e-4));
    robot.DisturbBody({.payload_link = "torso",
                       .payload_kg = payload_kg,
                       .push_link = "torso",
                       .push_force_N = {0.0, 0.0, 200.0}});
    robot.Step({}, kCycle_s, &sensors);
    return robot.state().velocity[5];
  };
  // The robot as one body would lose F t (1 / m - 1 / (m + 4 kg)) of its speed; its legs lag.
  const double without = falls_m_s(0.0), with = falls_m_s(4.0);
  EXPECT_LT(with, without - 200.0 * kCycle_s * (1.0 / 17.1 - 1.0 / 21.1));
  EXPECT_EQ(falls_m_s(std::nan("")), without);
  EXPECT_EQ(falls_m_s(-1.0), without);
}

// Readings of a standing robot over `ticks` cycles: foot force 2, current of joint 3, rate of the
// IMU about y, its turn about x.
std::vector<std::array<double, 4>> StandingReadings(const SensorNoise& noise, int ticks) {
  FloatingRobotConfig config = SquattingBiped();
  config.noise = noise;
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  provider::PlantSensors sensors;
  robot.Reset(&sensors);
  std::vector<std::array<double, 4>> out;
  for (int tick = 0; tick < ticks; ++tick) {
    robot.Step(command, kCycle_s, &sensors);
    const provider::BodySensors& body = *robot.body_sensors();
    out.push_back({body.foot_force_N[2], sensors.motor_current_A[3], body.angular_velocity_rad_s[1],
                   2.0 * body.orientation_wxyz[1] * body.orientation_wxyz[0]});
  }
  return out;
}

TEST(FloatingRobot, ItsSensorsHaveTheNoiseThatTheyAreGivenAndTheMotionHasNone) {
  constexpr int kTicks = 400;
  const SensorNoise noise = {.seed = 5,
                             .motor_current_A = 0.03,
                             .foot_force_N = 2.0,
                             .orientation_rad = 1e-3,
                             .angular_velocity_rad_s = 3e-3};
  const std::array<double, 4> deviations = {2.0, 0.03, 3e-3, 1e-3};
  const auto exact = StandingReadings({}, kTicks);
  const auto noisy = StandingReadings(noise, kTicks);
  EXPECT_EQ(noisy, StandingReadings(noise, kTicks));
  SensorNoise other = noise;
  other.seed = 6;
  EXPECT_NE(noisy, StandingReadings(other, kTicks));
  for (std::size_t k = 0; k < deviations.size(); ++k) {
    double sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double off = noisy[i][k] - exact[i][k];
      sum += off;
      squares += off * off;
    }
    // Of 400 values the deviation is known to 1 / sqrt(800), the mean to 1 / 20: four of these.
    EXPECT_NEAR(std::sqrt(squares / kTicks) / deviations[k], 1.0, 4.0 / std::sqrt(2.0 * kTicks));
    EXPECT_NEAR(sum / kTicks / deviations[k], 0.0, 4.0 / std::sqrt(kTicks));
  }
}

TEST(FloatingRobot, TheSpringOfAToeCarriesItsLoad) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  Simulate(&robot, HoldStart(config), kSettled_s);
  const int toe = arm::FindJoint(robot.links().chain, "left_toe_passive");
  const arm::Body& body = robot.links().chain.bodies[static_cast<std::size_t>(toe)];
  const Eigen::Isometry3d pose = robot.chain().Pose(toe);
  const Eigen::Vector3d axis = pose.linear() * body.axis;
  Eigen::Vector3d moment_Nm =
      (pose.linear() * body.com_m).cross(Eigen::Vector3d(0.0, 0.0, -9.81 * body.mass_kg));
  for (const std::size_t k : {6u, 7u}) {  // left front
    const arm::LinkFrame& frame = *arm::FindLink(robot.links(), config.contacts[k].link);
    EXPECT_EQ(frame.body, toe);
    const auto& force = robot.body_truth()->contact_force_N[k];
    moment_Nm += (pose.linear() * frame.body_from_link.translation())
                     .cross(Eigen::Vector3d(force[0], force[1], force[2]));
  }
  const double q = robot.state().joint_position_rad[toe];
  EXPECT_LT(q, -1e-2);
  EXPECT_NEAR(body.passive->stiffness_Nm_rad * q, moment_Nm.dot(axis), 2e-3);
}

std::vector<double> TraceOf(FloatingRobot* robot, const FloatingRobotConfig& config) {
  provider::PlantSensors sensors;
  robot->Reset(&sensors);
  std::vector<double> trace;
  provider::PlantCommand command = HoldStart(config);
  for (int k = 0; k < 500; ++k) {
    command.position_rad[3] += 1e-3;
    if (k == 100) {
      robot->DisturbBody({.payload_link = "torso",
                          .payload_kg = 2.0,
                          .push_link = "left_toe",
                          .push_force_N = {1.0, 2.0, 3.0}});
    }
    robot->Step(command, kCycle_s, &sensors);
    const FloatingState& state = robot->state();
    trace.insert(trace.end(), state.velocity.begin(), state.velocity.end());
    trace.insert(trace.end(), state.joint_position_rad.begin(), state.joint_position_rad.end());
    const auto& forces = robot->body_sensors()->foot_force_N;
    trace.insert(trace.end(), forces.begin(), forces.end());
  }
  return trace;
}

TEST(FloatingRobot, TwoRunsAreEqualToTheBit) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot first(config), second(config);
  const std::vector<double> a = TraceOf(&first, config), b = TraceOf(&second, config);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  const std::vector<double> again = TraceOf(&first, config);
  EXPECT_EQ(std::memcmp(a.data(), again.data(), a.size() * sizeof(double)), 0);
}

void StandsFor(const FloatingRobotConfig& config, double time_s) {
  FloatingRobot robot(config);
  Simulate(&robot, HoldStart(config), time_s);
  const double weight_N = 9.81 * robot.chain().mass_kg();
  EXPECT_NEAR(FeetSum(robot), weight_N, kWeightShare * weight_N);
  EXPECT_LT(robot.state().velocity.norm(), 1e-3);
  EXPECT_LT(robot.state().orientation.angularDistance(Eigen::Quaterniond::Identity()), 0.1);
}

TEST(FloatingRobot, TheBerkeleyHumanoidStands) {
  SKIP_WITHOUT_DATA(BipedPath(kBerkeleyBiped));
  StandsFor(BerkeleyRobot(), 4.0);
}

TEST(FloatingRobot, TheHighTorquePaiStands) {
  SKIP_WITHOUT_DATA(BipedPath(kPai));
  StandsFor(PaiRobot(), 4.0);
}

TEST(FloatingRobot, AStepAllocatesNothing) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  const provider::PlantCommand command = HoldStart(config);
  provider::PlantSensors sensors;
  robot.DisturbBody({.payload_link = "torso", .payload_kg = 1.0});
  const long before = test::Allocations();
  for (int k = 0; k < 10; ++k) robot.Step(command, kCycle_s, &sensors);
  EXPECT_EQ(test::Allocations(), before);
}

TEST(FloatingRobot, StopsAtTheLimitsOfTheUrdf) {
  FloatingRobotConfig config = SquattingBiped();
  config.base_height_m = 50.0;
  FloatingRobot robot(config);
  provider::PlantCommand command;
  const std::size_t knee = 3;
  ASSERT_EQ(config.model.joints[knee].name, "left_knee");
  command.mode[knee] = types::ControlMode::kTorque;
  command.motor_torque_Nm[knee] = -0.1;
  Simulate(&robot, command, 1.0);
  const int c = arm::FindJoint(robot.links().chain, "left_knee");
  EXPECT_NEAR(robot.state().joint_position_rad[c], 0.0, 2e-3);
  EXPECT_EQ(robot.state().velocity[kBaseFreedom + c], 0.0);
}

TEST(FloatingRobot, TakesValuesThatAreNotFiniteAsNone) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config), other(config);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  provider::PlantCommand bad;
  bad.mode[0] = types::ControlMode::kTorque;
  bad.motor_torque_Nm[0] = nan;
  robot.Disturb({.hand_force_N = {nan}, .extra_payload_kg = {nan}});
  robot.DisturbBody({.payload_kg = nan, .push_force_N = {nan, 0.0, 0.0}});
  provider::PlantSensors sensors;
  robot.Step(bad, kCycle_s, &sensors);
  EXPECT_FALSE(sensors.fault);
  other.Step({}, kCycle_s, &sensors);
  EXPECT_EQ(robot.state().velocity, other.state().velocity);
}

TEST(FloatingRobot, AStateThatWouldNotBeFiniteIsAFaultUntilReset) {
  FloatingRobotConfig config = SquattingBiped();
  config.model.joints[0].terms[0].linear[0].value = 1e306;
  config.model.joints[0].motor_torque_limit_Nm = 0.0;
  FloatingRobot robot(config);
  provider::PlantCommand command;
  command.mode[0] = types::ControlMode::kTorque;
  command.motor_torque_Nm[0] = 1e9;
  provider::PlantSensors sensors;
  for (int k = 0; k < 10; ++k) robot.Step(command, kCycle_s, &sensors);
  EXPECT_TRUE(sensors.fault);
  EXPECT_FALSE(sensors.valid[0]);
  EXPECT_THAT(sensors.message, HasSubstr("diverged"));
  EXPECT_TRUE(robot.state().velocity.allFinite());
  EXPECT_FALSE(robot.body_sensors()->imu_valid);
  robot.Reset(&sensors);
  robot.Step({}, kCycle_s, &sensors);
  EXPECT_FALSE(sensors.fault);
  EXPECT_TRUE(robot.body_sensors()->imu_valid);
}

// Contacts and toes carry the weight from the first step on. Joints that friction holds: nothing
// else gives way.
TEST(FloatingRobot, AStartAtRestIsInEquilibriumAndMovesAHundredTimesLessThanAnUprightOne) {
  FloatingRobotConfig config = SquattingBiped({.coulomb_Nm = 50.0});
  FloatingRobot upright(config);
  config.start = StartPose::kAtRest;
  FloatingRobot rest(config);
  EXPECT_NEAR(FeetSum(rest), 17.1 * 9.81, 1e-6);
  // The moment of the feet about the centre of mass is 0.
  double moment_Nm = 0.0;
  for (std::size_t i = 0; i < config.contacts.size(); ++i) {
    const arm::LinkFrame* link = arm::FindLink(rest.links(), config.contacts[i].link);
    const Eigen::Vector3d at =
        rest.chain().Point(link->body, link->body_from_link.translation()).position_m;
    moment_Nm += rest.contact_forces()[i].normal_N * (at.x() - rest.chain().CenterOfMass().x());
  }
  EXPECT_NEAR(moment_Nm, 0.0, 1e-6);
  const auto largest_rad_s = [&](FloatingRobot* robot) {
    provider::PlantSensors sensors;
    double largest = 0.0;
    for (int k = 0; k < 500; ++k) {
      robot->Step(HoldStart(config), kCycle_s, &sensors);
      largest = std::max(largest, robot->state().velocity.head<3>().norm());
    }
    return largest;
  };
  const double from_upright = largest_rad_s(&upright), from_rest = largest_rad_s(&rest);
  EXPECT_LT(from_rest, 0.01 * from_upright) << from_rest << " and " << from_upright << " rad/s";
}

TEST(FloatingRobot, ThereIsNoRestWhereTheRobotFallsOver) {
  FloatingRobotConfig config = SquattingBiped();
  config.start = StartPose::kAtRest;
  config.base_height_m = 0.7;
  EXPECT_THROW(FloatingRobot{config}, std::invalid_argument) << "two heights";
  config.base_height_m.reset();
  for (const char* side : {"left_ankle_pitch", "right_ankle_pitch"}) {  // far in front of the feet
    for (std::size_t j = 0; j < config.model.joints.size(); ++j) {
      if (config.model.joints[j].name == side) config.joints[j].position_rad = 0.7;
    }
  }
  EXPECT_THROW(FloatingRobot{config}, std::invalid_argument);
}

TEST(FloatingRobot, TheErrorsOfItsSensorsRepeatWithTheSeedAndLeaveTheMotionAlone) {
  FloatingRobotConfig config = SquattingBiped();
  FloatingRobot exact(config);
  config.imu_errors = kMpu6050;
  config.foot_errors = {.bandwidth_Hz = 50.0, .noise_density = 0.05, .bias = 2.0};
  FloatingRobot first(config), second(config);
  config.seed = 2;
  FloatingRobot other(config);
  for (FloatingRobot* robot : {&exact, &first, &second, &other}) {
    Simulate(robot, HoldStart(config), 0.1);
  }
  EXPECT_EQ(first.body_sensors()->acceleration_m_s2, second.body_sensors()->acceleration_m_s2);
  EXPECT_EQ(first.body_sensors()->foot_force_N, second.body_sensors()->foot_force_N);
  EXPECT_NE(first.body_sensors()->acceleration_m_s2, other.body_sensors()->acceleration_m_s2);
  EXPECT_NE(first.body_sensors()->foot_force_N, other.body_sensors()->foot_force_N);
  EXPECT_EQ(first.state().velocity, exact.state().velocity);
  EXPECT_EQ(first.body_truth()->contact_force_N, exact.body_truth()->contact_force_N);
  const std::array<double, 3> before = first.body_sensors()->angular_velocity_rad_s;
  provider::PlantSensors sensors;
  first.Reset(&sensors);
  Simulate(&first, HoldStart(config), 0.1);
  EXPECT_EQ(first.body_sensors()->angular_velocity_rad_s, before) << "a reset begins anew";
}

// The knee without its drive folds under the load, and comes back under power.
TEST(FloatingRobot, ALostDriveHasNoTorque) {
  const FloatingRobotConfig config = SquattingBiped();
  FloatingRobot robot(config);
  EXPECT_TRUE(robot.HasDrive("left_knee"));
  EXPECT_FALSE(robot.HasDrive("left_toe_passive"));
  EXPECT_FALSE(robot.HasDrive(""));
  Simulate(&robot, HoldStart(config), 0.5);
  robot.DisturbBody({.lost_drive = "left_knee"});
  provider::PlantSensors sensors;
  for (int k = 0; k < 50; ++k) robot.Step(HoldStart(config), kCycle_s, &sensors);
  const auto torque_Nm = [&](const std::string& name) {
    for (std::size_t j = 0; j < config.model.joints.size(); ++j) {
      if (config.model.joints[j].name == name) return sensors.torque_Nm[j];
    }
    ADD_FAILURE() << name;
    return 0.0;
  };
  EXPECT_EQ(torque_Nm("left_knee"), 0.0);
  EXPECT_GT(std::abs(torque_Nm("right_knee")), 1.0);
  robot.DisturbBody({});
  robot.Step(HoldStart(config), kCycle_s, &sensors);
  EXPECT_NE(torque_Nm("left_knee"), 0.0);
}

// A push below the limit of friction: with a tenth of the friction the feet slide.
TEST(FloatingRobot, OnSlipperyGroundThePushedRobotSlides) {
  const FloatingRobotConfig config = SquattingBiped();
  const auto slid_m = [&config](double lost_friction) {
    FloatingRobot robot(config);
    Simulate(&robot, HoldStart(config), 1.0);
    robot.DisturbBody(
        {.push_link = "pelvis", .push_force_N = {0.0, 25.0, 0.0}, .lost_friction = lost_friction});
    const arm::LinkFrame* foot = arm::FindLink(robot.links(), "left_foot");
    const auto place = [&] {
      return robot.chain().Point(foot->body, Eigen::Vector3d::Zero()).position_m.y();
    };
    const double before_m = place();
    Simulate(&robot, HoldStart(config), 0.3);
    return place() - before_m;
  };
  EXPECT_LT(std::abs(slid_m(0.0)), 1e-2);
  EXPECT_GT(slid_m(0.9), 2e-2) << "0.08 of the weight are 13 N";
}

TEST(FloatingRobot, RefusesWhatCannotBe) {
  const auto error_of = [](const FloatingRobotConfig& config) -> std::string {
    try {
      FloatingRobot robot(config);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "no error";
  };
  const FloatingRobotConfig good = SquattingBiped();
  FloatingRobotConfig config = good;
  config.contacts[0].link = "left_hand";
  EXPECT_THAT(error_of(config), HasSubstr("left_hand"));
  config = good;
  config.contacts[0].point_m.x() = std::nan("");
  EXPECT_THAT(error_of(config), HasSubstr("not finite"));
  config = good;
  config.imu_link = "left_foot";
  EXPECT_THAT(error_of(config), ::testing::AllOf(HasSubstr("left_foot"), HasSubstr("moves")));
  config = good;
  config.contacts.clear();
  EXPECT_THAT(error_of(config), HasSubstr("base_height_m"));
  config = good;
  config.model.joints[2].terms.push_back(
      actuator::MakeTerm("gravity", config.model.joints[2].constants));
  EXPECT_THAT(error_of(config), HasSubstr("left_hip_pitch"));
  config = good;
  config.joints[1].declared_payload_kg = 1.0;
  EXPECT_THAT(error_of(config), HasSubstr("payload"));
  config = good;
  config.model.joints.pop_back();
  config.joints.pop_back();
  EXPECT_THAT(error_of(config),
              ::testing::AllOf(HasSubstr("right_ankle_roll"), HasSubstr("model")));
  config = good;
  for (arm::Body& body : config.chain.bodies) body.passive.reset();
  EXPECT_THAT(error_of(config), HasSubstr("left_toe_passive"));
  config = good;
  config.substep_s = 0.0;
  EXPECT_THAT(error_of(config), HasSubstr("substep_s"));
}

}  // namespace
}  // namespace sinew::world

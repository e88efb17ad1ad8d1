// The robot on a floating base with actuated joints against DART.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "sim/world/floating_robot.h"
#include "tests/sim/world/dart_skeleton.h"
#include "tests/sim/world/robot.h"

namespace sinew::world {
namespace {

// One step from rest, against DART's inverse inertia with the rotors added to the inertia.
TEST(FloatingRobot, RotorsAddTheirInertiaToTheJoints) {
  FloatingRobotConfig config = Flying(1e-4);
  FloatingRobot robot(config);
  const arm::Chain& merged = robot.links().chain;
  DartChain dart(merged, /*fixed_base=*/false);
  provider::PlantCommand command;
  Eigen::VectorXd torque = Eigen::VectorXd::Zero(robot.chain().joint_count());
  for (int j = 0; j < robot.joint_count(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    command.mode[at] = types::ControlMode::kTorque;
    command.motor_torque_Nm[at] = 0.02 * std::cos(3.0 * j);
    const int body = arm::FindJoint(merged, config.model.joints[at].name);
    torque[body] = 100.0 * command.motor_torque_Nm[at];
  }
  dart.SetState(robot.state());
  Eigen::VectorXd free(robot.chain().freedom());
  dart.Solve(torque, {}, free);
  const Eigen::MatrixXd inertia = dart.Responses().inverse();
  Eigen::MatrixXd with_rotors = inertia;
  for (std::size_t c = 0; c < merged.bodies.size(); ++c) {
    const auto at = kBaseFreedom + static_cast<Eigen::Index>(c);
    if (!merged.bodies[c].passive) with_rotors(at, at) += 0.05;
  }
  const Eigen::VectorXd expected = with_rotors.ldlt().solve(inertia * free);
  provider::PlantSensors sensors;
  robot.Step(command, 1e-4, &sensors);
  const Eigen::VectorXd found = robot.state().velocity / 1e-4;
  EXPECT_LT((found - expected).norm(), 1e-9 * expected.norm());
  EXPECT_GT((free - expected).norm(), 0.1 * free.norm());
}

}  // namespace
}  // namespace sinew::world

// robots/biped through CAN: the squat of the benchmark, what feet and IMU report of it, and what
// the loss of one of their nodes does. Frames, bit times and limits are the deployment's; time is
// simulated.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "bridge/can/bit_timing.h"
#include "bridge/can/sensor_node.h"
#include "components/base/types/angle.h"
#include "components/base/types/gravity.h"
#include "components/model/actuator/file/model_file.h"
#include "tests/robots/biped/can_biped.h"

namespace sinew {
namespace {

using types::RobotState;
using virtual_axes::BodyFaultKind;

constexpr double kBottom_s = 2.5;   // of the reference: half of a squat
constexpr double kMse_rad2 = 4e-5;  // 1.7e-5 found: drives without integrator yield to their load
// What is carried is a sample, its way and a cycle old, 9 ms at most, in which load and motion go
// on: 0.59 N and 0.21 mrad found. Rate: five deviations of 1.7 mrad/s on each of three axes beside
// that (12.5 mrad/s found). Mean specific force: 1 % of g (0.075 found: the torso shakes with the
// steps of the setpoints, and the node samples it without a low-pass).
constexpr double kFoot_N = 2.0, kOrientation_rad = 0.002, kRate_rad_s = 0.03, kForce_m_s2 = 0.1;
constexpr int kLeftFoot = 0, kRightFoot = 1, kImu = 2;  // in the order of virtual_axes.yaml

Eigen::Vector3d Vector(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

Eigen::Quaterniond Rotation(const std::array<double, 4>& wxyz) {
  return {wxyz[0], wxyz[1], wxyz[2], wxyz[3]};
}

// Of the IMU, world axes: biped.urdf has it 0.1 m and 0.06 m above the base's origin.
Eigen::Vector3d ImuVelocity(const provider::BodyTruth& base) {
  const Eigen::Vector3d arm_m = Rotation(base.orientation_wxyz) * Eigen::Vector3d(0.0, 0.0, 0.16);
  return Vector(base.velocity_m_s) + Vector(base.angular_velocity_rad_s).cross(arm_m);
}

// README.md, "Through CAN", and docs/participants/can_bridge.md, "Rates": bits a second at worst
// stuffing, from the two files.
struct Load {
  int bus;
  double rate_Hz;
  bool torque;
};

double WorstLoad_percent(const virtual_axes::VirtualAxesConfig& nodes,
                         const bridge::BridgeConfig& map, const Load& load) {
  const auto per_s = [](int every_ms) { return every_ms > 0 ? 1e3 / every_ms : 0.0; };
  double bits_s = 0.0;
  for (const virtual_axes::AxisConfig& axis : nodes.axes) {
    if (axis.bus != load.bus) continue;
    const double iq_s = load.rate_Hz / map.timing.iq_every_cycles;
    bits_s +=
        load.rate_Hz * can::WorstFrameBits(load.torque ? 4 : 8) +
        iq_s * (can::WorstFrameBits(0) + can::WorstFrameBits(8)) +
        (per_s(axis.rates.encoder_ms) + per_s(axis.rates.heartbeat_ms)) * can::WorstFrameBits(8);
  }
  for (const virtual_axes::SensorNodeConfig& node : nodes.nodes) {
    if (node.bus != load.bus) continue;
    const can::Frame valves = can::Encode(node.node, can::ValveCommand{});
    bits_s += (per_s(node.encoder_ms) + per_s(node.sensors_ms) + per_s(node.heartbeat_ms)) *
                  can::WorstFrameBits(8) +
              load.rate_Hz * can::WorstFrameBits(valves.length);
  }
  for (const virtual_axes::BodyNodeConfig& node : nodes.body_nodes) {
    if (node.bus != load.bus) continue;
    const int frames = node.part == can::BodyPart::kImu ? 3 : 1;
    bits_s += (frames * per_s(node.sample_ms) + per_s(node.heartbeat_ms)) * can::WorstFrameBits(8);
  }
  return 100.0 * bits_s / map.bitrate_bit_s[static_cast<std::size_t>(load.bus)];
}

// What the IMU measures adds up to what the base has done: the specific force, turned into world
// axes, less gravity, to the change of its own velocity.
TEST(BipedThroughCan, SquatsAndFeetAndImuReportWhatTheWorldHas) {
  CanBiped biped;
  EXPECT_EQ(biped.Arm(), provider::OperatorResult::kRefusedByFallGuard) << "not yet observed";
  biped.StandUp();
  if (HasFatalFailure()) return;
  const provider::BodyTruth begin = *biped.robot().body_truth();
  double square_rad2 = 0.0, foot_N = 0.0, orientation_rad = 0.0, rate_rad_s = 0.0;
  Eigen::Vector3d gained_m_s = Eigen::Vector3d::Zero();
  int steps = 0;
  const double period_s = biped.cycle().period_s();
  for (double t = 0.0; t < kBottom_s; t += period_s, ++steps) {
    biped.Step(t);
    ASSERT_EQ(biped.state(), RobotState::kArmed) << t << " s: " << biped.message();
    const provider::BodySensors& carried = biped.body();
    const provider::BodyTruth& truth = *biped.robot().body_truth();
    for (std::size_t i = 0; i < 8; ++i) {
      ASSERT_TRUE(carried.foot_valid[i]) << t;
      foot_N = std::max(foot_N, std::abs(carried.foot_force_N[i] - truth.contact_force_N[i][2]));
    }
    ASSERT_TRUE(carried.imu_valid) << t;
    const Eigen::Quaterniond q_WB = Rotation(truth.orientation_wxyz);
    orientation_rad =
        std::max(orientation_rad, q_WB.angularDistance(Rotation(carried.orientation_wxyz)));
    rate_rad_s = std::max(rate_rad_s, (q_WB * Vector(carried.angular_velocity_rad_s) -
                                       Vector(truth.angular_velocity_rad_s))
                                          .norm());
    gained_m_s += period_s * (q_WB * Vector(carried.acceleration_m_s2) -
                              Eigen::Vector3d(0.0, 0.0, types::kGravity_m_s2));
    for (std::size_t j = 0; j < CanBiped::kJoints; ++j) {
      const double wanted = biped.reference().config.joints[j].trajectory->At(t).position_rad;
      square_rad2 += std::pow(wanted - biped.sensors().position_rad[j], 2);
    }
  }
  const provider::BodyTruth& end = *biped.robot().body_truth();
  const double mse_rad2 = square_rad2 / (static_cast<double>(CanBiped::kJoints) * steps);
  const double sunk_m = begin.position_m[2] - end.position_m[2];
  const double force_m_s2 =
      (gained_m_s - (ImuVelocity(end) - ImuVelocity(begin))).norm() / (steps * period_s);
  std::printf(
      "MSE %.3g rad2; base sunk by %.3f m; feet within %.2f N; IMU: %.3f m/s2 in the mean, "
      "rate within %.4f rad/s, orientation within %.5f rad\n",
      mse_rad2, sunk_m, foot_N, force_m_s2, rate_rad_s, orientation_rad);
  EXPECT_NEAR(sunk_m, 0.4 - 0.02, 0.01) << "depth less the margin of straight legs";
  EXPECT_LT(mse_rad2, kMse_rad2);
  EXPECT_LT(foot_N, kFoot_N);
  EXPECT_LT(orientation_rad, kOrientation_rad);
  EXPECT_LT(rate_rad_s, kRate_rad_s);
  EXPECT_LT(force_m_s2, kForce_m_s2);
  for (std::size_t bus = 0; bus < 2; ++bus) {
    EXPECT_EQ(biped.report().frames_dropped[bus], 0U);
    EXPECT_EQ(biped.report().body_samples_missed[bus], 0U);
    const double worst =
        WorstLoad_percent(biped.axes_config(), biped.map(), {static_cast<int>(bus), 240.0, false});
    std::printf("load of bus %zu: %.1f %%, at worst %.1f %%\n", bus,
                biped.report().load_percent[bus], worst);
    EXPECT_LT(biped.report().load_percent[bus], worst);
    EXPECT_GT(biped.report().load_percent[bus], 0.8 * worst) << "111 of 135 bits are not stuffed";
  }
}

// Pushed to the left, it stands on its left foot, and on the outer side of both.
TEST(BipedThroughCan, EachForceSensorIsItsOwn) {
  CanBiped biped;
  biped.StandUp();
  if (HasFatalFailure()) return;
  biped.Push({0.0, 10.0, 0.0});
  biped.StandFor(1.0);
  ASSERT_EQ(biped.state(), RobotState::kArmed) << biped.message();
  const provider::BodyTruth& truth = *biped.robot().body_truth();
  double left_N = 0.0, right_N = 0.0;
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(biped.body().foot_force_N[i], truth.contact_force_N[i][2], kFoot_N) << i;
    (i < 4 ? right_N : left_N) += biped.body().foot_force_N[i];
  }
  EXPECT_GT(left_N, right_N + 8.0 * kFoot_N);
}

struct Loss {
  const char* name;
  int node;  // in the configuration's order
  BodyFaultKind kind;
  const char* lost;
};

class LostNode : public ::testing::TestWithParam<Loss> {};

// Within the time of the fall detector: 20 ms until the node's last sample is too old, 50 ms
// without a usable one, and two cycles.
TEST_P(LostNode, IsAFaultWithItsNameAndMotorsOffAsTheGuardDeclares) {
  CanBiped biped;
  biped.StandUp();
  if (HasFatalFailure()) return;
  biped.axes().FalsifyBodyNode(GetParam().node, {GetParam().kind, 0.0});
  double passed_s = 0.0;
  for (; biped.state() == RobotState::kArmed && passed_s < 1.0;
       passed_s += biped.cycle().period_s()) {
    biped.Step();
  }
  EXPECT_EQ(biped.state(), RobotState::kFault);
  EXPECT_EQ(biped.message(), std::string("fall: not known, lost: ") + GetParam().lost);
  EXPECT_LT(passed_s, 0.100);
  for (std::size_t i = 0; i < 8; ++i) {  // the right foot's four first
    const bool lost = GetParam().node == (i < 4 ? kRightFoot : kLeftFoot);
    EXPECT_EQ(biped.body().foot_valid[i], !lost) << i;
  }
  EXPECT_EQ(biped.body().imu_valid, GetParam().node != kImu);
  biped.StandFor(0.05);
  for (int axis = 0; axis < static_cast<int>(CanBiped::kJoints); ++axis) {
    EXPECT_EQ(biped.axes().axis_state(axis), can::AxisState::kIdle) << axis;
  }
  EXPECT_EQ(biped.Arm(), provider::OperatorResult::kRefusedResetFirst);
  const std::size_t bus = GetParam().node == kRightFoot ? 1 : 0;
  EXPECT_EQ(biped.report().body_nodes_lost[bus], 1U);
  EXPECT_EQ(biped.report().body_nodes_lost[1 - bus], 0U);
}

INSTANTIATE_TEST_SUITE_P(
    BipedThroughCan, LostNode,
    ::testing::Values(Loss{"LeftFootSilent", kLeftFoot, BodyFaultKind::kLost, "feet"},
                      Loss{"RightFootFrozen", kRightFoot, BodyFaultKind::kFrozen, "feet"},
                      Loss{"ImuSilent", kImu, BodyFaultKind::kLost, "imu"},
                      Loss{"ImuFrozen", kImu, BodyFaultKind::kFrozen, "imu"}),
    [](const auto& tested) { return std::string(tested.param.name); });

TEST(BipedThroughCan, ARobotWhoseFootOrImuIsAbsentIsNotArmed) {
  for (const int node : {kLeftFoot, kRightFoot, kImu}) {
    CanBiped biped;
    biped.axes().FalsifyBodyNode(node, {BodyFaultKind::kLost, 0.0});
    biped.StandFor(2.0 * CanBiped::kDetectorStarts_s);
    EXPECT_EQ(biped.Arm(), provider::OperatorResult::kRefusedByFallGuard) << node;
    EXPECT_EQ(biped.state(), RobotState::kDisarmed);
    EXPECT_TRUE(biped.axes().held());
    // What is still there is reported all the same.
    EXPECT_EQ(biped.body().foot_valid[0], node != kRightFoot);
    EXPECT_EQ(biped.body().foot_valid[4], node != kLeftFoot);
    EXPECT_EQ(biped.body().imu_valid, node != kImu);
  }
}

// Without the hoist the legs give way before the bridge has armed the axes.
TEST(BipedThroughCan, TheRobotHangsUntilAllItsAxesAreDriven) {
  CanBiped biped;
  const double start_m = biped.robot().body_truth()->position_m[2];
  biped.StandFor(1.0);
  EXPECT_TRUE(biped.axes().held());
  EXPECT_EQ(biped.robot().body_truth()->position_m[2], start_m);
}

TEST(BipedThroughCan, TheBusesHaveTheLoadThatTheReadmeStates) {
  const CanBiped biped;
  const std::string readme = config::ReadFile(kBipedFiles + "README.md");
  for (const double rate_Hz : {200.0, 240.0}) {
    for (const bool torque : {false, true}) {
      char row[96];
      std::snprintf(row, sizeof row, "| %.0f Hz, %s | %.1f %% | %.1f %% |", rate_Hz,
                    torque ? "torque" : "position",
                    WorstLoad_percent(biped.axes_config(), biped.map(), {0, rate_Hz, torque}),
                    WorstLoad_percent(biped.axes_config(), biped.map(), {1, rate_Hz, torque}));
      EXPECT_NE(readme.find(row), std::string::npos) << "README.md has not: " << row;
    }
  }
}

TEST(BipedThroughCan, ThePageOfTheBridgeStatesTheLoadsAsShipped) {
  const CanBiped biped;
  const std::string rig = SINEW_SOURCE_DIR "/robots/rig/";
  const auto axes = config::Read<virtual_axes::VirtualAxesFile>(
      config::Section::Load(rig + "virtual_axes.yaml", virtual_axes::kSchema));
  const auto map = config::Read<bridge::BridgeFile>(
      config::Section::Load(rig + "can_bridge.yaml", bridge::kSchema));
  const double rate_Hz = provider::ProviderOptions().rate_Hz;
  const auto left = [&](bool torque) {
    return WorstLoad_percent(biped.axes_config(), biped.map(), {0, rate_Hz, torque});
  };
  const auto right = [&](bool torque) {
    return WorstLoad_percent(biped.axes_config(), biped.map(), {1, rate_Hz, torque});
  };
  char text[256];
  std::snprintf(text, sizeof text,
                "| %.0f Hz, worst content | %.1f %% | %.1f %% | %.1f %% | %.1f %% | %.1f %% |",
                rate_Hz, WorstLoad_percent(axes.axes, map.bridge, {0, rate_Hz, true}), left(false),
                left(true), right(false), right(true));
  const std::string page = config::ReadFile(SINEW_SOURCE_DIR "/docs/participants/can_bridge.md");
  EXPECT_NE(page.find(text), std::string::npos) << "can_bridge.md has not: " << text;
  std::snprintf(text, sizeof text, "%.0f to %.0f %% on the biped's left bus", left(true),
                left(false));
  const std::string bring_up = config::ReadFile(SINEW_SOURCE_DIR "/docs/bring-up.md");
  EXPECT_NE(bring_up.find(text), std::string::npos) << "bring-up.md has not: " << text;
}

// The bridge's map against the robot's model and URDF, and against the nodes that answer it.
TEST(BipedThroughCan, TheMapDescribesTheRobotOfTheModel) {
  const CanBiped biped;
  const actuator::RobotModel model = actuator::LoadRobotModel(kBipedFiles + "model.yaml");
  ASSERT_EQ(biped.map().joints.size(), CanBiped::kJoints);
  ASSERT_EQ(biped.axes_config().axes.size(), CanBiped::kJoints);
  constexpr double kPrinted = 1e-5;  // six digits, of values up to 1
  for (std::size_t j = 0; j < CanBiped::kJoints; ++j) {
    const bridge::JointConfig& joint = biped.map().joints[j];
    const actuator::JointModel& of_model = model.joints[j];
    EXPECT_EQ(joint.name, of_model.name);
    EXPECT_EQ(joint.gear_ratio, of_model.constants.gear_ratio) << joint.name;
    EXPECT_EQ(joint.torque_constant_Nm_A, of_model.constants.torque_constant_Nm_A);
    EXPECT_EQ(joint.torque_efficiency, of_model.Parameter("drive_current", "efficiency"));
    EXPECT_EQ(joint.limits.motor_torque_Nm, of_model.motor_torque_limit_Nm) << joint.name;
    const virtual_axes::AxisConfig& axis = biped.axes_config().axes[j];
    EXPECT_EQ(axis.joint, static_cast<int>(j));
    EXPECT_EQ(axis.bus, joint.bus) << joint.name;
    EXPECT_EQ(axis.node, joint.node) << joint.name;
    EXPECT_EQ(axis.gear_ratio, joint.gear_ratio) << joint.name;
    EXPECT_EQ(axis.torque_constant_Nm_A, joint.torque_constant_Nm_A) << joint.name;
    EXPECT_EQ(axis.controller_torque_constant_Nm_A, joint.controller_torque_constant_Nm_A);
    // The whole squat is inside the limits of position and velocity.
    const auto& trajectory = *biped.reference().config.joints[j].trajectory;
    for (double t = 0.0; t < 10.0; t += 0.01) {
      const auto wanted = trajectory.At(t);
      ASSERT_GT(wanted.position_rad, joint.limits.lower_rad) << joint.name << ' ' << t;
      ASSERT_LT(wanted.position_rad, joint.limits.upper_rad) << joint.name << ' ' << t;
      ASSERT_LT(std::abs(wanted.velocity_rad_s), joint.limits.velocity_rad_s) << joint.name;
    }
    EXPECT_NEAR(axis.velocity_limit_rev_s * axis.torque_constant_Nm_A, 24.0 / types::kTwoPi,
                24.0 * kPrinted)
        << "no load at 24 V";
  }
}

}  // namespace
}  // namespace sinew

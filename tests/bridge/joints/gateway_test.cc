// The compact exchange through a gateway: the bridge's plant, virtual axes, and the bus between
// them at its bit times.
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/plant_bench.h"
#include "tests/support/allocations.h"

namespace sinew::bridge {
namespace {

using types::FaultCause;

// Half a step of 0.01 motor turns.
constexpr double kRounding_rad = 0.005 * types::kTwoPi;

BenchSetup Twelve() {
  return {.joints = 12, .output_nodes = false, .gateway = true, .rate_Hz = 400.0};
}

TEST(Gateway, SensorsAreThePlantsRoundedToTheirSteps) {
  Bench bench(Twelve());
  for (std::size_t j = 0; j < 12; ++j)
    bench.rotors.angle_rad[j] = 7.0 * static_cast<double>(j) - 30.0;
  bench.Start();
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_NEAR(bench.sensors.motor_position_rad[j], bench.rotors.angle_rad[j],
                kRounding_rad * 1.001)
        << j;
    EXPECT_TRUE(bench.sensors.valid[j]);
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

// The exchange that 400 Hz was asked of: references of twelve joints out, their state, forces and
// IMU in, heartbeats of all axes beside it, on one bus of 1 Mbit/s.
TEST(Gateway, TwelveJointsFollowTheirReferencesAt400HzOnOneBus) {
  Bench bench(Twelve());
  bench.Start();
  bench.Arm(ControlMode::kPosition);
  int late = 0;
  double oldest_us = 0.0;
  for (int i = 0; i < 1200; ++i) {
    for (std::size_t j = 0; j < 12; ++j) {
      bench.command.position_rad[j] =
          0.3 * std::sin(0.005 * static_cast<double>(i) + 0.5 * static_cast<double>(j));
    }
    bench.Step();
    const double age_us = bench.sensors.age_us[0];
    oldest_us = std::max(oldest_us, age_us);
    if (age_us > 2500.0) ++late;
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_NEAR(bench.rotors.angle_rad[j] / 100.0, bench.command.position_rad[j], 0.05) << j;
    EXPECT_NEAR(bench.sensors.position_rad[j], bench.rotors.angle_rad[j] / 100.0, 0.02) << j;
  }
  // A state in each cycle, but where the heartbeats of all axes come at once, ten times a second:
  // there it is one later.
  EXPECT_LE(late, 2 * (1200 / 40 + 1));
  EXPECT_LT(oldest_us, 5000.0);
  const provider::BusReport& report = *bench.plant->bus_report();
  EXPECT_EQ(report.frames_dropped[0], 0U);
  EXPECT_LT(report.load_percent[0], 100.0);
  EXPECT_EQ(bench.plant->malformed(), 0U);
  // References to the state's last frame: the bits of 17 frames, heartbeats in between.
  EXPECT_GT(report.answer_p50_us[0], 1700.0);
  EXPECT_LT(report.answer_p50_us[0], 2400.0);
  EXPECT_LT(report.answer_max_us[0], 4500.0);
}

TEST(Gateway, ArmingInPositionModeMovesNothing) {
  Bench bench(Twelve());
  for (double& angle : bench.rotors.angle_rad) angle = 41.7;
  bench.Start();
  for (double& position : bench.command.position_rad) position = 0.417;
  bench.Arm(ControlMode::kPosition);
  bench.Steps(100);
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_NEAR(bench.rotors.angle_rad[j], 41.7, 2.0 * kRounding_rad) << j;
  }
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

// A reference must not overwrite the torque of a joint that is not in position control.
TEST(Gateway, AJointInTorqueModeHasASetpointOfItsOwn) {
  Bench bench(Twelve());
  bench.Start();
  bench.Arm(ControlMode::kPosition);
  bench.command.mode[5] = ControlMode::kTorque;
  bench.command.motor_torque_Nm[5] = 0.0007;
  bench.Steps(5);
  for (int i = 0; i < 40; ++i) {
    bench.Step();
    EXPECT_NEAR(bench.rotors.torque_Nm[5], 0.0007, 1e-9);
  }
  EXPECT_GT(bench.rotors.velocity_rad_s[5], 1.0);
  EXPECT_NEAR(bench.rotors.angle_rad[4], 0.0, 2.0 * kRounding_rad) << "its neighbour stands";
  EXPECT_NEAR(bench.sensors.motor_current_A[5], 0.0007 / Rotors::kTorqueConstant_Nm_A, 0.0051);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

// It has moved since its last position setpoint; references come behind the change of mode.
TEST(Gateway, FromTorqueToPositionModeNothingJumps) {
  Bench bench(Twelve());
  bench.Start();
  bench.Arm(ControlMode::kPosition);
  bench.command.mode[5] = ControlMode::kTorque;
  bench.command.motor_torque_Nm[5] = 0.002;
  bench.Steps(80);
  ASSERT_GT(bench.rotors.angle_rad[5], 3.0);
  bench.command.motor_torque_Nm[5] = 0.0;
  bench.Steps(1500);  // it runs out
  ASSERT_LT(bench.rotors.velocity_rad_s[5], 0.05);
  const double rest_rad = bench.rotors.angle_rad[5];
  bench.command.mode[5] = ControlMode::kPosition;
  bench.command.position_rad[5] = rest_rad / 100.0;
  double strongest_Nm = 0.0;
  bench.on_frame = [&](const can::Delivery&) {
    strongest_Nm = std::max(strongest_Nm, std::abs(bench.rotors.torque_Nm[5]));
  };
  bench.Steps(40);
  EXPECT_LT(strongest_Nm, 5e-4) << "that of the rounding is 1.6e-4, of an old setpoint above 1e-2";
  EXPECT_NEAR(bench.rotors.angle_rad[5], rest_rad, 2.0 * kRounding_rad);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(Gateway, ReferencesFeedTheWatchdogsAlsoWhileDisarmed) {
  BenchSetup setup = Twelve();
  setup.watchdog_s = 0.05;
  Bench bench(setup);
  bench.Start();
  bench.Steps(400);
  for (int j = 0; j < 12; ++j) EXPECT_EQ(bench.axes->axis_error(j), 0U) << j;
  bench.Arm(ControlMode::kPosition);
  bench.Steps(200);
  for (int j = 0; j < 12; ++j) EXPECT_EQ(bench.axes->axis_error(j), 0U) << j;
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 60 * kMs_ns);  // the bridge is killed
  for (int j = 0; j < 12; ++j) EXPECT_EQ(bench.axes->axis_state(j), can::AxisState::kIdle) << j;
}

TEST(Gateway, ShutDownLeavesTheAxesIdle) {
  Bench bench(Twelve());
  bench.Start();
  bench.Arm(ControlMode::kPosition);
  bench.plant->ShutDown();
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 10 * kMs_ns);
  for (int j = 0; j < 12; ++j) EXPECT_EQ(bench.axes->axis_state(j), can::AxisState::kIdle) << j;
}

TEST(Gateway, FeetAndImuAreReported) {
  Bench bench(Twelve());
  bench.rotors.body.emplace();
  provider::BodySensors& body = *bench.rotors.body;
  for (std::size_t i = 0; i < 8; ++i) body.foot_force_N[i] = 12.3 * static_cast<double>(i);
  body.acceleration_m_s2 = {0.5, -1.25, 9.81};
  body.angular_velocity_rad_s = {0.125, -2.5, 0.003};
  const double half_rad = 0.5 * 0.4;
  body.orientation_wxyz = {std::cos(half_rad), 0.0, std::sin(half_rad), 0.0};  // 0.4 rad of pitch
  bench.Start();
  bench.Steps(3);
  const provider::BodySensors* reported = bench.plant->body_sensors();
  ASSERT_NE(reported, nullptr);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_NEAR(reported->foot_force_N[i], body.foot_force_N[i], 0.051);
    EXPECT_TRUE(reported->foot_valid[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(reported->acceleration_m_s2[i], body.acceleration_m_s2[i], 0.0051);
    EXPECT_NEAR(reported->angular_velocity_rad_s[i], body.angular_velocity_rad_s[i], 0.00051);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(reported->orientation_wxyz[i], body.orientation_wxyz[i], 1e-4) << i;
  }
  EXPECT_TRUE(reported->imu_valid);
  Bench without({.joints = 1});
  without.Start();
  EXPECT_EQ(without.plant->body_sensors(), nullptr);
}

TEST(Gateway, ASilentGatewayIsAFaultOfEveryJointBehindIt) {
  Bench bench(Twelve());
  bench.Start();
  // The axes' heartbeats go on, the states end.
  bench.axes_config.gateways.clear();
  bench.ends.push_back(bench.buses[0]->Join("axes without gateway"));
  bench.axes = std::make_unique<virtual_axes::VirtualAxes>(
      bench.axes_config, bench.rotors, std::vector<can::Transport*>{bench.ends.back().get()});
  bench.axes->Start(bench.buses[0]->now_ns());
  bench.Steps(40);
  for (int j = 0; j < 12; ++j) EXPECT_EQ(bench.plant->fault(j), FaultCause::kEstimatesLost) << j;
}

TEST(Gateway, APositionBeyondTheFieldIsAFaultNotAWrongAngle) {
  Bench bench(Twelve());
  bench.config.joints[3].limits.upper_rad = bench.config.joints[3].limits.lower_rad + 1000.0;
  bench.rotors.angle_rad[3] = 328.0 * types::kTwoPi;
  bench.Start();
  EXPECT_EQ(bench.plant->fault(3), FaultCause::kOutOfRange) << bench.sensors.message;
  EXPECT_EQ(bench.plant->fault(2), FaultCause::kNone);
}

TEST(Gateway, AReferenceBeyondTheFieldIsAFaultAndMovesNothing) {
  Bench bench(Twelve());
  JointLimits& limits = bench.config.joints[3].limits;
  limits = {0.398, 25.0, 500.0, -100.0, 100.0, 0.2, 90.0};
  bench.rotors.angle_rad[3] = 320.0 * types::kTwoPi;
  bench.Start();
  bench.command.position_rad[3] = 320.0 * types::kTwoPi / 100.0;
  bench.Arm(ControlMode::kPosition);
  ASSERT_FALSE(bench.faulty()) << bench.sensors.message;
  bench.command.position_rad[3] = 330.0 * types::kTwoPi / 100.0;
  bench.Steps(3);
  EXPECT_EQ(bench.plant->fault(3), FaultCause::kOutOfRange) << bench.sensors.message;
  bench.Steps(50);
  EXPECT_EQ(bench.axes->axis_state(3), can::AxisState::kIdle);
  EXPECT_LT(bench.rotors.angle_rad[3], 328.0 * types::kTwoPi);
}

TEST(Gateway, ActAndStepTakeNothingFromTheHeap) {
  const Bench bench({.joints = 1, .output_nodes = false, .gateway = true});
  Deaf bus;
  bus.frames = {can::Encode(1, can::Heartbeat{0, can::AxisState::kClosedLoopControl})};
  for (const can::Frame& frame : can::EncodeState(Bench::kGatewayNode, {})) {
    bus.frames.push_back(frame);
  }
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  command.mode[0] = ControlMode::kPosition;
  const long before = test::Allocations();
  for (int i = 0; i < 500; ++i) {
    bus.now += kPeriod_ns;
    bus.next = 0;
    plant.Act(command, kPeriod_s);
    plant.Step(command, kPeriod_s, &sensors);
  }
  EXPECT_EQ(test::Allocations() - before, 0);
  EXPECT_FALSE(sensors.any_fault()) << sensors.message;
}

TEST(Gateway, ConfigurationThatCannotBeIsRefused) {
  const auto refused = [](auto change) {
    Bench bench({.joints = 2, .buses = 2, .output_nodes = false});
    bench.config.gateways.push_back({0, 48, {0}});
    change(bench.config);
    return RefusalOf(bench.config);
  };
  EXPECT_EQ(refused([](BridgeConfig&) {}), "accepted");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.gateways[0].node = 1; }),
            "gateway of node 1: node 1 is used twice");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.gateways[0].bus = 7; }),
            "gateway of node 48: no bus 7");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.gateways[0].joints = {1}; }),
            "gateway of node 48: joint 'joint1' is on another bus");
  EXPECT_EQ(refused([](BridgeConfig& c) {
              c.gateways[0].joints = {0, 0};
            }),
            "gateway of node 48: joint 'joint0' is behind a gateway already");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.gateways[0].joints.clear(); }),
            "gateway of node 48: 0 joints, expected 1 to 12");
  EXPECT_EQ(refused([](BridgeConfig& c) { c.gateways[0].joints = {9}; }),
            "gateway of node 48: no joint 9");
}

}  // namespace
}  // namespace sinew::bridge

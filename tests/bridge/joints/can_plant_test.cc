// The bridge against virtual controllers on a bus in memory: simulated time, every frame seen.
// Here the cycle: conventions of torque and angle, Act and Step, statistics, long runs.
#include "bridge/joints/can_plant.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bridge/can/bit_timing.h"
#include "tests/bridge/joints/plant_bench.h"
#include "tests/support/allocations.h"

namespace sinew::bridge {
namespace {

TEST(CanPlant, SensorsAreThePlantsThroughFrames) {
  Bench bench;
  bench.rotors.angle_rad[0] = 30.0;
  bench.rotors.pressure_bar[0] = 4.2;
  bench.rotors.temperature_degC[0] = 31.4;
  bench.Start();
  EXPECT_NEAR(bench.sensors.motor_position_rad[0], 30.0, 1e-5);
  EXPECT_NEAR(bench.sensors.position_rad[0], 0.3, 1e-6);
  EXPECT_NEAR(bench.sensors.chamber_pressure_bar[0], 4.2, 1e-9);
  EXPECT_NEAR(bench.sensors.motor_temperature_degC[0], 31.4, 1e-9);
  EXPECT_TRUE(bench.sensors.valid[0]);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  EXPECT_LT(bench.sensors.age_us[0], 10'000);
}

// The law that matters: whatever direction, zero and constant the controller has, the motor feels
// the torque.
class Conventions : public ::testing::TestWithParam<int> {};

TEST_P(Conventions, MotorFeelsTheCommandedTorque) {
  Bench bench({.direction = GetParam(), .zero_rev = 3.7});
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.0011;
  bench.Steps(3);
  // float32 on the wire: 24 bits
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.0011, 1e-9);
  bench.Steps(60);
  EXPECT_GT(bench.rotors.velocity_rad_s[0], 5.0) << "positive drives up";
  EXPECT_NEAR(bench.sensors.motor_velocity_rad_s[0], bench.rotors.velocity_rad_s[0],
              0.02 * bench.rotors.velocity_rad_s[0]);
  EXPECT_NEAR(bench.sensors.motor_current_A[0], 0.0011 / test::Rotors::kTorqueConstant_Nm_A, 1e-6);
  EXPECT_NEAR(bench.sensors.torque_Nm[0], 100 * 0.0011, 1e-6);
  EXPECT_GT(bench.sensors.position_rad[0], 0.0);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

INSTANTIATE_TEST_SUITE_P(Directions, Conventions, ::testing::Values(1, -1));

TEST(CanPlant, WithoutAnOutputNodeThePositionIsTheMotors) {
  Bench bench({.output_nodes = false});
  bench.rotors.angle_rad[0] = 30.0;
  bench.Start();
  EXPECT_NEAR(bench.sensors.position_rad[0], 0.3, 1e-6);
  EXPECT_EQ(bench.plant->measured_flags() & 1u, 0u) << "not measured";
  Bench with;
  with.Start();
  EXPECT_EQ(with.plant->measured_flags() & 1u, 1u);
}

TEST(CanPlant, ValvesFollowTheCommandAndShutWhenTheBridgeDies) {
  Bench bench;
  bench.Start();
  bench.command.valve_open[0] = true;
  bench.command.compressor_on[0] = true;
  bench.Steps(3);
  EXPECT_TRUE(bench.rotors.last_command.valve_open[0]);
  EXPECT_TRUE(bench.rotors.last_command.compressor_on[0]);
  EXPECT_FALSE(bench.rotors.last_command.vent_open[0]);
  EXPECT_TRUE(bench.sensors.valve_open[0]) << "as the node reads it back";
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 70 * kMs_ns);
  EXPECT_FALSE(bench.rotors.last_command.valve_open[0]);
  EXPECT_FALSE(bench.rotors.last_command.compressor_on[0]);
}

TEST(CanPlant, RequestedEstimatesAreOfThisCycle) {
  Bench bench({.estimates = Estimates::kRequested});
  bench.axes_config.step_s = 0.0002;
  bench.axes_config.nodes[0].encoder_ms = 1;
  bench.axes_config.nodes[0].sensors_ms = 1;
  bench.Start();
  bench.Steps(20);
  for (int i = 0; i < 100; ++i) {
    bench.Step();
    ASSERT_LT(bench.sensors.age_us[0], 1500);
  }
}

TEST(CanPlant, ActSendsAtOnceAndTheStepAfterItOnlyReads) {
  Bench bench;
  bench.Start();
  bench.Arm();
  int setpoints = 0;
  bench.buses[0]->OnFrame([&](const can::Delivery& d) {
    if (can::Decode<can::SetInputTorque>(d.frame)) ++setpoints;
  });
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.plant->Act(bench.command, kPeriod_s);
  bench.buses[0]->AdvanceTo(bench.buses[0]->now_ns() + 2 * kMs_ns);
  EXPECT_EQ(setpoints, 1);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.001, 1e-9);
  bench.Step();
  EXPECT_EQ(setpoints, 1);
  bench.Step();
  EXPECT_EQ(setpoints, 2) << "without Act, Step sends";
}

TEST(CanPlant, ActAndStepTakeNothingFromTheHeap) {
  const Bench bench;
  Deaf bus;
  bus.frames = {can::Encode(1, can::Heartbeat{0, can::AxisState::kClosedLoopControl}),
                can::Encode(1, can::EncoderEstimates{0.1, 0.0}), can::Encode(1, can::Iq{0.1, 0.2}),
                can::Encode(33, can::OutputEncoder{0.25, 0, 0, true}),
                can::Encode(33, can::JointSensors{})};
  CanPlant plant(bench.config, {&bus});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  command.mode[0] = ControlMode::kTorque;
  command.motor_torque_Nm[0] = 0.001;
  const long before = test::Allocations();
  for (int i = 0; i < 500; ++i) {
    bus.now += kPeriod_ns;
    bus.next = 0;
    bus.frames[3].data[6]++;  // its sequence number
    plant.Act(command, kPeriod_s);
    plant.Step(command, kPeriod_s, &sensors);
  }
  EXPECT_EQ(test::Allocations() - before, 0);
  EXPECT_FALSE(sensors.any_fault()) << sensors.message;
}

TEST(CanPlant, OldFirmwareWorksAsWell) {
  Bench bench;
  bench.config.joints[0].firmware = bench.axes_config.axes[0].firmware = can::Firmware::k0_5_1;
  bench.Start();
  bench.Arm();
  bench.command.motor_torque_Nm[0] = 0.001;
  bench.Steps(5);
  EXPECT_NEAR(bench.rotors.torque_Nm[0], 0.001, 1e-9);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
}

TEST(CanPlant, TwelveJointsOnTwoBusesRunFaultlessAndEachMovesItsOwn) {
  Bench bench({.joints = 12, .buses = 2});
  for (auto& node : bench.axes_config.nodes) node.sensors_ms = 20;
  bench.config.timing.estimate_timeout_s = 0.03;
  bench.config.timing.iq_every_cycles = 4;
  for (auto& axis : bench.axes_config.axes) axis.rates.encoder_ms = 4;
  bench.Start();
  bench.Arm();
  for (std::size_t j = 0; j < 12; ++j)
    bench.command.motor_torque_Nm[j] = 1e-4 * (static_cast<double>(j) - 5.5);
  bench.Steps(240);
  EXPECT_FALSE(bench.faulty()) << bench.sensors.message;
  for (std::size_t j = 0; j < 12; ++j) {
    EXPECT_NEAR(bench.rotors.torque_Nm[j], bench.command.motor_torque_Nm[j], 1e-9) << j;
    EXPECT_NEAR(bench.sensors.position_rad[j], bench.rotors.angle_rad[j] / 100.0, 0.02) << j;
    EXPECT_TRUE(bench.sensors.valid[j]) << j;
  }
  const provider::BusReport& report = *bench.plant->bus_report();
  EXPECT_EQ(report.bus_count, 2);
  for (std::size_t b = 0; b < 2; ++b) {
    EXPECT_TRUE(report.up[b]);
    EXPECT_EQ(report.frames_dropped[b], 0U);
    EXPECT_GT(report.load_percent[b], 20.0);
    EXPECT_LT(report.load_percent[b], 100.0);
  }
}

// One axis, an idle bus: the question's and the answer's bit times, and up to a step of the axis.
TEST(CanPlant, AnswersAreTimedFromTheirQuestion) {
  Bench bench({.output_nodes = false});
  bench.Start();
  EXPECT_EQ(bench.plant->bus_report()->answer_max_us[0], 0.0);
  bench.Steps(500);
  const provider::BusReport& report = *bench.plant->bus_report();
  const int question = can::FrameBits(can::EncodeRequest(1, can::Command::kGetIq));
  EXPECT_GT(report.answer_p50_us[0], question + 8 * 8 + 47);
  EXPECT_LT(report.answer_max_us[0], 1000.0 + 4 * 135.0);
  EXPECT_GE(report.answer_max_us[0], report.answer_p50_us[0]);
  Bench quiet({.output_nodes = false});
  quiet.config.timing.iq_every_cycles = 0;
  quiet.Start();
  quiet.Steps(600);  // beyond the start, which asks for estimates
  EXPECT_EQ(quiet.plant->bus_report()->answer_p50_us[0], 0.0) << "nothing was asked";
}

TEST(CanPlant, LoadIsTheBusTimeOfTheFrames) {
  Bench bench;
  bench.Start();
  const auto busy = [&] { return bench.buses[0]->model().counters().busy_ns; };
  bench.Steps(245);
  const std::int64_t before = busy();
  const std::int64_t start = bench.buses[0]->now_ns();
  bench.Steps(480);
  const double percent = 100.0 * static_cast<double>(busy() - before) /
                         static_cast<double>(bench.buses[0]->now_ns() - start);
  EXPECT_NEAR(bench.plant->bus_report()->load_percent[0], percent, 0.05 * percent);
}

TEST(CanPlant, LongRunKeepsStepAndFaultless) {
  Bench bench;
  bench.Start();
  bench.Arm();
  for (int i = 0; i < 240 * 120; ++i) {
    bench.command.motor_torque_Nm[0] = -2e-3 * bench.sensors.motor_position_rad[0] / 10.0 +
                                       5e-4 * std::sin(0.01 * i) -
                                       1e-4 * bench.sensors.motor_velocity_rad_s[0];
    bench.Step();
    ASSERT_FALSE(bench.faulty()) << i << " " << bench.sensors.message;
    ASSERT_TRUE(bench.sensors.valid[0]) << i;
  }
  EXPECT_EQ(bench.plant->malformed(), 0U);
}

}  // namespace
}  // namespace sinew::bridge

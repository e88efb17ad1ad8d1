// The model of a motor controller alone: frames in, answers and demands out; no bus, no plant.
#include "bridge/virtual_axes/axis_model.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "components/base/types/angle.h"
#include "components/base/types/control_mode.h"

namespace sinew::virtual_axes {
namespace {

using can::AxisState;
using can::Command;

constexpr double kWire = 1e-8;  // Nm: 0.1 Nm as float32

class Model : public ::testing::Test {
 protected:
  Model() { config.node = 3; }
  void Build() {
    axis.emplace(config);
    axis->Start(now_ns, 0);
  }
  template <class Message>
  std::optional<can::Frame> Take(const Message& message) {
    return axis->Take(can::Encode(3, message, config.firmware), motor, now_ns);
  }
  void CloseLoop(can::ControlMode mode) {
    (void)Take(can::SetControllerMode{mode});
    (void)Take(can::SetAxisState{AxisState::kClosedLoopControl});
    ASSERT_EQ(axis->state(), AxisState::kClosedLoopControl);
  }
  provider::PlantCommand Driven() {
    provider::PlantCommand command;
    axis->Drive(motor, &command);
    return command;
  }
  template <class Message>
  Message Ask(Command command) {
    const auto answer = axis->Take(can::EncodeRequest(3, command), motor, now_ns);
    EXPECT_TRUE(answer.has_value());
    const auto message =
        answer ? can::Decode<Message>(*answer, config.firmware) : std::optional<Message>();
    EXPECT_TRUE(message.has_value());
    return message.value_or(Message{});
  }

  AxisConfig config;
  std::optional<AxisModel> axis;
  MotorState motor{1.25, 0.5, 0.75};
  std::int64_t now_ns = 1'000 * kMs_ns;
};

TEST_F(Model, MotorIsThePlantsInTheControllersDirectionAndZero) {
  config.direction = -1;
  config.zero_rev = 2.0;
  config.joint = 1;
  Build();
  provider::PlantSensors sensors;
  sensors.motor_position_rad[1] = types::kTwoPi;
  sensors.motor_velocity_rad_s[1] = 2.0 * types::kTwoPi;
  sensors.motor_current_A[1] = 3.0;
  const MotorState state = axis->MotorOf(sensors);
  EXPECT_DOUBLE_EQ(state.position_rev, 1.0);
  EXPECT_DOUBLE_EQ(state.velocity_rev_s, -2.0);
  EXPECT_EQ(state.iq_A, -3.0);
}

TEST_F(Model, EverySequenceEndsIdleAndAnUnknownStateIsAnError) {
  Build();
  for (const AxisState state :
       {AxisState::kIdle, AxisState::kStartupSequence, AxisState::kFullCalibration,
        AxisState::kMotorCalibration, AxisState::kEncoderIndexSearch,
        AxisState::kEncoderOffsetCalibration, AxisState::kEncoderDirFind, AxisState::kHoming,
        AxisState::kHallPolarityCalibration, AxisState::kHallPhaseCalibration}) {
    CloseLoop(can::ControlMode::kTorque);
    (void)Take(can::SetAxisState{state});
    EXPECT_EQ(axis->state(), AxisState::kIdle);
    EXPECT_EQ(axis->error(), 0U);
  }
  (void)Take(can::SetAxisState{AxisState{99}});
  EXPECT_EQ(axis->error(), can::axis_error::kInvalidState);
}

TEST_F(Model, ClosedLoopStartsWhereTheMotorIsAndNotWithAnError) {
  Build();
  (void)Take(can::SetInputPos{100.0, 5.0, 0.1});
  CloseLoop(can::ControlMode::kPosition);
  EXPECT_NEAR(Driven().position_rad[0], 1.25 * types::kTwoPi, 1e-12);
  EXPECT_EQ(axis->input_torque_Nm(), 0.0);
  axis->Fail(can::axis_error::kMotorFailed);
  (void)Take(can::SetAxisState{AxisState::kClosedLoopControl});
  EXPECT_EQ(axis->state(), AxisState::kIdle);
}

TEST_F(Model, VoltageAndUnknownControlModesAreAnError) {
  for (const int mode : {0, 4, 255}) {
    Build();
    (void)Take(can::SetControllerMode{static_cast<can::ControlMode>(mode)});
    EXPECT_EQ(axis->error(), can::axis_error::kControllerFailed);
    EXPECT_EQ(Ask<can::ControllerError>(Command::kGetControllerError).error, 0x2U);
    (void)Take(can::ClearErrors{});
    EXPECT_EQ(axis->error(), 0U);
  }
}

// The current is the setpoint by the controller's constant; the motor's torque by the motor's.
TEST_F(Model, TorqueIsDrivenByTheCurrentWithinItsLimit) {
  config.direction = -1;
  Build();
  CloseLoop(can::ControlMode::kTorque);
  (void)Take(can::SetInputTorque{0.1});
  const double current_A = 0.1 / config.controller_torque_constant_Nm_A;
  EXPECT_EQ(Driven().mode[0], types::ControlMode::kTorque);
  EXPECT_NEAR(Driven().motor_torque_Nm[0], -current_A * config.torque_constant_Nm_A, kWire);
  EXPECT_NEAR(Ask<can::Iq>(Command::kGetIq).setpoint_A, current_A, 1e-5);
  (void)Take(can::SetLimits{80.0, -2.0});  // its size counts
  EXPECT_DOUBLE_EQ(Driven().motor_torque_Nm[0], -2.0 * config.torque_constant_Nm_A);
  (void)Take(can::SetLimits{80.0, std::nan("")});
  EXPECT_DOUBLE_EQ(Driven().motor_torque_Nm[0], -2.0 * config.torque_constant_Nm_A);
  (void)Take(can::SetInputTorque{std::nan("")});
  EXPECT_EQ(Driven().motor_torque_Nm[0], 0.0);
}

TEST_F(Model, VelocityIsDrivenAtTheOutputWithinItsLimit) {
  config.gear_ratio = 50.0;
  config.direction = -1;
  Build();
  CloseLoop(can::ControlMode::kVelocity);
  (void)Take(can::SetInputVel{10.0, 0.0});
  EXPECT_EQ(Driven().mode[0], types::ControlMode::kVelocity);
  EXPECT_NEAR(Driven().velocity_rad_s[0], -10.0 * types::kTwoPi / 50.0, 1e-9);
  EXPECT_EQ(Ask<can::Iq>(Command::kGetIq).setpoint_A, 0.75) << "the loop's is the measured one";
  (void)Take(can::SetLimits{4.0, 25.0});
  EXPECT_NEAR(Driven().velocity_rad_s[0], -4.0 * types::kTwoPi / 50.0, 1e-9);
  (void)Take(can::SetLimits{std::numeric_limits<double>::infinity(), 25.0});
  EXPECT_NEAR(Driven().velocity_rad_s[0], -4.0 * types::kTwoPi / 50.0, 1e-9);
}

TEST_F(Model, APositionThatIsNotFiniteLeavesThePlantsTarget) {
  Build();
  CloseLoop(can::ControlMode::kPosition);
  (void)Take(can::SetInputPos{std::numeric_limits<double>::infinity(), 0.0, 0.0});
  provider::PlantCommand command;
  command.position_rad[0] = 0.7;
  axis->Drive(motor, &command);
  EXPECT_EQ(command.mode[0], types::ControlMode::kPosition);
  EXPECT_EQ(command.position_rad[0], 0.7);
}

TEST_F(Model, AnIdleAxisDrivesNothing) {
  Build();
  (void)Take(can::SetInputTorque{0.1});
  EXPECT_EQ(Driven().mode[0], types::ControlMode::kIdle);
  EXPECT_EQ(Driven().motor_torque_Nm[0], 0.0);
}

TEST_F(Model, WatchdogExpiresAfterItsTimeWithoutAFrame) {
  config.watchdog_s = 0.1;
  Build();
  CloseLoop(can::ControlMode::kTorque);
  axis->CheckWatchdog(now_ns + 100 * kMs_ns);
  EXPECT_EQ(axis->error(), 0U);
  now_ns += 100 * kMs_ns;
  can::Frame unknown;
  unknown.id = 3U << 5 | 0x1FU;
  EXPECT_FALSE(axis->Take(unknown, motor, now_ns)) << "feeds it all the same";
  axis->CheckWatchdog(now_ns + 100 * kMs_ns);
  EXPECT_EQ(axis->error(), 0U);
  axis->CheckWatchdog(now_ns + 100 * kMs_ns + 1);
  EXPECT_EQ(axis->error(), can::axis_error::kWatchdogTimerExpired);
  EXPECT_EQ(axis->state(), AxisState::kIdle);
}

TEST_F(Model, WithoutAWatchdogSilenceIsNoError) {
  Build();
  axis->CheckWatchdog(now_ns + 3'600'000 * kMs_ns);
  EXPECT_EQ(axis->error(), 0U);
}

TEST_F(Model, OverspeedBeyondTheToleranceIsAnErrorInClosedLoopOnly) {
  config.velocity_limit_rev_s = 10.0;
  Build();
  axis->CheckSpeed({0.0, 20.0, 0.0});
  EXPECT_EQ(axis->error(), 0U) << "idle";
  CloseLoop(can::ControlMode::kTorque);
  axis->CheckSpeed({0.0, -11.9, 0.0});
  EXPECT_EQ(axis->error(), 0U);
  axis->CheckSpeed({0.0, -12.1, 0.0});
  EXPECT_EQ(axis->error(), can::axis_error::kControllerFailed);
  EXPECT_EQ(Ask<can::ControllerError>(Command::kGetControllerError).error, 0x1U);
}

TEST_F(Model, EveryRequestIsAnsweredWithTheMotorsState) {
  Build();
  EXPECT_EQ(Ask<can::EncoderEstimates>(Command::kGetEncoderEstimates).position_rev, 1.25);
  EXPECT_EQ(Ask<can::SensorlessEstimates>(Command::kGetSensorlessEstimates).velocity_rev_s, 0.5);
  const auto count = Ask<can::EncoderCount>(Command::kGetEncoderCount);
  EXPECT_EQ(count.shadow_count, 16384 * 5 / 4);
  EXPECT_EQ(count.count_in_cpr, 16384 / 4);
  EXPECT_EQ(Ask<can::Iq>(Command::kGetIq).measured_A, 0.75);
  const auto bus = Ask<can::BusVoltageCurrent>(Command::kGetBusVoltageCurrent);
  EXPECT_EQ(bus.voltage_V, 24.0);
  EXPECT_NEAR(bus.current_A, 0.75 * config.torque_constant_Nm_A * types::kTwoPi * 0.5 / 24.0, 1e-8);
  EXPECT_EQ(Ask<can::MotorError>(Command::kGetMotorError).error, 0U);
  EXPECT_EQ(Ask<can::EncoderError>(Command::kGetEncoderError).error, 0U);
  EXPECT_EQ(Ask<can::SensorlessError>(Command::kGetSensorlessError).error, 0U);
  const auto voltage = Take(can::AdcRequest{1});
  ASSERT_TRUE(voltage);
  EXPECT_EQ(can::Decode<can::AdcVoltage>(*voltage)->voltage_V, 0.0);
}

TEST_F(Model, Firmware054SendsTheSetpointAsIqAnd051HasNoCurrentLimit) {
  config.firmware = can::Firmware::k0_5_4;
  Build();
  CloseLoop(can::ControlMode::kTorque);
  (void)Take(can::SetInputTorque{config.controller_torque_constant_Nm_A});
  (void)Driven();
  EXPECT_NEAR(Ask<can::Iq>(Command::kGetIq).measured_A, 1.0, 1e-6);
  config.firmware = can::Firmware::k0_5_1;
  Build();
  CloseLoop(can::ControlMode::kTorque);
  (void)Take(can::SetLimits{80.0, 1.0});
  (void)Take(can::SetInputTorque{2.0 * config.controller_torque_constant_Nm_A});
  EXPECT_NEAR(Driven().motor_torque_Nm[0], 2.0 * config.torque_constant_Nm_A, kWire);
}

TEST_F(Model, ASilencedAxisAnswersNothingAndObeys) {
  Build();
  axis->Silence(true);
  EXPECT_TRUE(axis->is_silent(now_ns));
  EXPECT_FALSE(axis->Take(can::EncodeRequest(3, Command::kGetIq), motor, now_ns));
  const auto due = axis->Due(motor, now_ns + 1'000 * kMs_ns);
  EXPECT_EQ(due.begin(), due.end());
  CloseLoop(can::ControlMode::kTorque);
}

TEST_F(Model, ARebootIsThreeTenthsOfASecondOfSilenceAndForgetsErrorsAndLimits) {
  config.watchdog_s = 0.1;
  Build();
  (void)Take(can::SetLimits{1.0, 1.0});
  axis->Fail(can::axis_error::kMotorFailed);
  (void)Take(can::Reboot{});
  EXPECT_EQ(axis->error(), 0U);
  now_ns += 299 * kMs_ns;
  EXPECT_TRUE(axis->is_silent(now_ns));
  axis->CheckWatchdog(now_ns);
  EXPECT_EQ(axis->error(), 0U);
  (void)Take(can::SetAxisState{AxisState::kClosedLoopControl});
  EXPECT_EQ(axis->state(), AxisState::kIdle) << "receives nothing";
  now_ns += kMs_ns;
  EXPECT_FALSE(axis->is_silent(now_ns));
  CloseLoop(can::ControlMode::kTorque);
  (void)Take(can::SetInputTorque{2.0 * config.controller_torque_constant_Nm_A});
  EXPECT_NEAR(Driven().motor_torque_Nm[0], 2.0 * config.torque_constant_Nm_A, kWire)
      << "the current limit is the configured one again";
}

TEST_F(Model, AReferenceMovesPositionControlOnlyAndFeedsTheWatchdog) {
  config.watchdog_s = 0.1;
  Build();
  CloseLoop(can::ControlMode::kTorque);
  (void)Take(can::SetInputTorque{0.01});
  now_ns += 100 * kMs_ns;
  axis->TakeReference(7.0, now_ns);
  axis->CheckWatchdog(now_ns + 100 * kMs_ns);
  EXPECT_EQ(axis->error(), 0U);
  EXPECT_NEAR(axis->input_torque_Nm(), 0.01, 1e-9);
  (void)Take(can::SetControllerMode{can::ControlMode::kPosition});
  axis->TakeReference(7.0, now_ns);
  EXPECT_EQ(axis->input_torque_Nm(), 0.0);
  EXPECT_NEAR(Driven().position_rad[0], 7.0 * types::kTwoPi, 1e-9);
  (void)Take(can::Reboot{});
  axis->TakeReference(8.0, now_ns);
  now_ns += 300 * kMs_ns;
  axis->CheckWatchdog(now_ns + 50 * kMs_ns);
  EXPECT_EQ(axis->error(), 0U) << "the reference during the reboot is ignored: it feeds nothing";
  CloseLoop(can::ControlMode::kPosition);
  EXPECT_NEAR(Driven().position_rad[0], 1.25 * types::kTwoPi, 1e-12);
}

TEST_F(Model, AnotherNodeNumberIsTakenWhenItExists) {
  Build();
  (void)Take(can::SetAxisNodeId{64});
  EXPECT_EQ(axis->node(), 3);
  (void)Take(can::SetAxisNodeId{63});
  EXPECT_EQ(axis->node(), 63);
}

TEST_F(Model, CyclicMessagesComeAtTheirRates) {
  config.rates = {100, 10, 20, 0, 50, 0, 0};
  Build();
  std::array<int, 32> count{};
  for (int ms = 0; ms < 1000; ++ms) {
    for (const can::Frame& frame : axis->Due(motor, now_ns + ms * kMs_ns)) {
      ++count[frame.id & 31];
    }
  }
  EXPECT_EQ(count[static_cast<std::size_t>(Command::kHeartbeat)], 10);
  EXPECT_EQ(count[static_cast<std::size_t>(Command::kGetEncoderEstimates)], 100);
  EXPECT_EQ(count[static_cast<std::size_t>(Command::kGetIq)], 50);
  EXPECT_EQ(count[static_cast<std::size_t>(Command::kGetMotorError)], 20);
  EXPECT_EQ(count[static_cast<std::size_t>(Command::kGetBusVoltageCurrent)], 0);
}

}  // namespace
}  // namespace sinew::virtual_axes

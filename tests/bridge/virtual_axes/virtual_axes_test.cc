// The virtual controllers against the firmware they stand in for: what a master sees on the bus.
#include "bridge/virtual_axes/virtual_axes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <stdexcept>

#include "components/base/types/angle.h"
#include "tests/bridge/virtual_axes/rotors.h"
#include "tests/support/memory_can.h"

namespace sinew::virtual_axes {
namespace {

using can::AxisState;
using can::Command;
using can::Frame;
using std::chrono::milliseconds;

constexpr std::int64_t kMs_ns = 1'000'000;

class Master : public ::testing::Test {
 protected:
  void Build(AxisConfig axis, bool with_node = false) {
    VirtualAxesConfig config;
    axis.gear_ratio = 100.0;
    config.axes.push_back(axis);
    if (with_node) {
      SensorNodeConfig node;
      node.node = 32;
      config.nodes.push_back(node);
    }
    Build(config);
  }
  void Build(const VirtualAxesConfig& config) {
    axes_end_ = bus_.Join("axes");
    master_ = bus_.Join("master");
    axes_ = std::make_unique<VirtualAxes>(config, rotors_,
                                          std::vector<can::Transport*>{axes_end_.get()});
    axes_->Start(bus_.now_ns());
    bus_.AddAgent([this] { return axes_->next_ns(); },
                  [this](std::int64_t now) { axes_->Run(now); });
  }
  static AxisConfig Axis(int node) {
    AxisConfig axis;
    axis.node = node;
    return axis;
  }
  template <class Message>
  void Send(int node, const Message& message) {
    ASSERT_EQ(master_->Send(can::Encode(node, message, firmware_)), can::SendStatus::kOk);
  }
  // Lets time pass and drops what was received.
  void Pass(milliseconds time) {
    bus_.AdvanceTo(bus_.now_ns() + std::chrono::nanoseconds(time).count());
    can::Received received;
    while (master_->Receive(milliseconds(0), &received)) {
    }
  }
  // The next message of this type within the time.
  template <class Message>
  std::optional<Message> Await(milliseconds time, int node) {
    const std::int64_t give_up = bus_.now_ns() + std::chrono::nanoseconds(time).count();
    can::Received received;
    while (master_->Receive(std::chrono::nanoseconds(give_up - bus_.now_ns()), &received)) {
      const auto address = can::AddressOf(received.frame);
      if (!address || address->node != node) continue;
      if (const auto message = can::Decode<Message>(received.frame, firmware_)) return message;
    }
    return std::nullopt;
  }
  void CloseLoop(int node) {
    Send(node, can::SetControllerMode{});
    Send(node, can::SetAxisState{AxisState::kClosedLoopControl});
    Pass(milliseconds(3));
  }

  can::Firmware firmware_ = can::Firmware::k0_5_6;
  can::MemoryBus bus_{{}};
  test::Rotors rotors_{1};
  std::unique_ptr<can::Transport> axes_end_, master_;
  std::unique_ptr<VirtualAxes> axes_;
};

TEST_F(Master, TheHandPushesItsJointOfThePlantAndNothingElse) {
  Build(Axis(3));
  axes_->SetHand(0, 12.0);
  EXPECT_EQ(rotors_.disturbance.hand_force_N,
            (provider::Disturbance{.hand_force_N = {12.0}}.hand_force_N));
  axes_->SetHand(0, std::nan(""));
  EXPECT_EQ(rotors_.disturbance.hand_force_N[0], 0.0);
  EXPECT_THROW(axes_->SetHand(types::kMaxJoints, 1.0), std::out_of_range);
}

TEST_F(Master, HeartbeatComesTenTimesASecondAndEstimatesAHundredTimes) {
  Build(Axis(3));
  int heartbeats = 0, estimates = 0, others = 0;
  can::Received received;
  while (bus_.now_ns() < 2'000 * kMs_ns) {
    if (!master_->Receive(milliseconds(1), &received)) continue;
    const auto address = can::AddressOf(received.frame);
    ASSERT_EQ(address->node, 3);
    if (address->command == Command::kHeartbeat) {
      ++heartbeats;
    } else if (address->command == Command::kGetEncoderEstimates) {
      ++estimates;
    } else {
      ++others;
    }
  }
  EXPECT_NEAR(heartbeats, 20, 1);
  EXPECT_NEAR(estimates, 200, 2);
  EXPECT_EQ(others, 0);
}

TEST_F(Master, TorqueInClosedLoopAcceleratesTheRotorAsNewtonSays) {
  AxisConfig config = Axis(1);
  config.rates.iq_ms = 10;
  Build(config);
  CloseLoop(1);
  const double torque_controller_Nm = 0.002;  // as the controller counts, 8.27/KV
  Send(1, can::SetInputTorque{torque_controller_Nm});
  const std::int64_t start = bus_.now_ns();
  Pass(milliseconds(200));
  const double current_A = torque_controller_Nm / config.controller_torque_constant_Nm_A;
  const double torque_Nm = current_A * config.torque_constant_Nm_A;
  const double time_s = 1e-9 * static_cast<double>(bus_.now_ns() - start);
  const double rate_1_s = test::Rotors::kDrag_Nm_s_rad / test::Rotors::kInertia_kg_m2;
  const double expected_rad_s =
      torque_Nm / test::Rotors::kDrag_Nm_s_rad * (1.0 - std::exp(-rate_1_s * time_s));
  // One step of 1 ms is the axis' own latency: 0.7 % of 200 ms, and Euler's error.
  EXPECT_NEAR(rotors_.velocity_rad_s[0], expected_rad_s, 0.015 * expected_rad_s);
  const auto iq = Await<can::Iq>(milliseconds(20), 1);
  ASSERT_TRUE(iq);
  EXPECT_NEAR(iq->measured_A, current_A, 1e-5);
  EXPECT_NEAR(iq->setpoint_A, current_A, 1e-5);
  const auto estimates = Await<can::EncoderEstimates>(milliseconds(20), 1);
  ASSERT_TRUE(estimates);
  EXPECT_NEAR(estimates->velocity_rev_s, rotors_.velocity_rad_s[0] / types::kTwoPi, 0.05);
}

TEST_F(Master, TorqueInIdleMovesNothing) {
  Build(Axis(1));
  Send(1, can::SetInputTorque{0.1});
  Pass(milliseconds(100));
  EXPECT_EQ(rotors_.angle_rad[0], 0.0);
}

TEST_F(Master, DirectionAndZeroOfTheEncoderAreTheAxis) {
  AxisConfig config = Axis(1);
  config.direction = -1;
  config.zero_rev = 12.5;
  rotors_.angle_rad[0] = 3.0;
  Build(config);
  const auto estimates = Await<can::EncoderEstimates>(milliseconds(20), 1);
  ASSERT_TRUE(estimates);
  EXPECT_NEAR(estimates->position_rev, 12.5 - 3.0 / types::kTwoPi, 1e-5);
  CloseLoop(1);
  Send(1, can::SetInputTorque{0.002});
  Pass(milliseconds(50));
  EXPECT_LT(rotors_.velocity_rad_s[0], 0.0);
}

TEST_F(Master, RequestsAreAnsweredWithinTwoMilliseconds) {
  AxisConfig config = Axis(5);
  config.rates.encoder_ms = 0;
  Build(config);
  Pass(milliseconds(5));
  ASSERT_EQ(master_->Send(can::EncodeRequest(5, Command::kGetBusVoltageCurrent)),
            can::SendStatus::kOk);
  const auto voltage = Await<can::BusVoltageCurrent>(milliseconds(2), 5);
  ASSERT_TRUE(voltage);
  EXPECT_EQ(voltage->voltage_V, 24.0);
  for (const Command command :
       {Command::kGetMotorError, Command::kGetEncoderError, Command::kGetSensorlessError,
        Command::kGetEncoderEstimates, Command::kGetEncoderCount, Command::kGetIq,
        Command::kGetSensorlessEstimates, Command::kGetControllerError}) {
    ASSERT_EQ(master_->Send(can::EncodeRequest(5, command)), can::SendStatus::kOk);
    can::Received received;
    bool answered = false;
    const std::int64_t give_up = bus_.now_ns() + 2 * kMs_ns;
    while (!answered &&
           master_->Receive(std::chrono::nanoseconds(give_up - bus_.now_ns()), &received)) {
      answered = received.frame.id == can::Identifier(5, command) && !received.frame.remote;
    }
    EXPECT_TRUE(answered) << static_cast<int>(command);
  }
}

TEST_F(Master, EstopIsAnErrorThatHoldsUntilItIsCleared) {
  Build(Axis(1));
  CloseLoop(1);
  ASSERT_EQ(axes_->axis_state(0), AxisState::kClosedLoopControl);
  Send(1, can::Estop{});
  Pass(milliseconds(3));
  EXPECT_EQ(axes_->axis_state(0), AxisState::kIdle);
  EXPECT_EQ(axes_->axis_error(0), can::axis_error::kEstopRequested);
  CloseLoop(1);
  EXPECT_EQ(axes_->axis_state(0), AxisState::kIdle) << "no closed loop with an error";
  Send(1, can::ClearErrors{});
  CloseLoop(1);
  EXPECT_EQ(axes_->axis_state(0), AxisState::kClosedLoopControl);
  const auto heartbeat = Await<can::Heartbeat>(milliseconds(150), 1);
  ASSERT_TRUE(heartbeat);
  EXPECT_EQ(heartbeat->axis_state, AxisState::kClosedLoopControl);
  EXPECT_EQ(heartbeat->axis_error, 0U);
}

TEST_F(Master, WatchdogStopsAnAxisThatNobodyTalksTo) {
  AxisConfig config = Axis(1);
  config.watchdog_s = 0.05;
  Build(config);
  CloseLoop(1);
  for (int i = 0; i < 20; ++i) {
    Send(1, can::SetInputTorque{0.001});
    Pass(milliseconds(40));
    ASSERT_EQ(axes_->axis_state(0), AxisState::kClosedLoopControl);
  }
  Pass(milliseconds(60));
  EXPECT_EQ(axes_->axis_state(0), AxisState::kIdle);
  EXPECT_EQ(axes_->axis_error(0), can::axis_error::kWatchdogTimerExpired);
  EXPECT_EQ(rotors_.torque_Nm[0], 0.0);
}

TEST_F(Master, OverspeedIsAControllerError) {
  AxisConfig config = Axis(1);
  config.velocity_limit_rev_s = 5.0;
  Build(config);
  CloseLoop(1);
  Send(1, can::SetInputTorque{0.05});
  Pass(milliseconds(300));
  EXPECT_EQ(axes_->axis_state(0), AxisState::kIdle);
  EXPECT_EQ(axes_->axis_error(0), can::axis_error::kControllerFailed);
  ASSERT_EQ(master_->Send(can::EncodeRequest(1, Command::kGetControllerError)),
            can::SendStatus::kOk);
  const auto error = Await<can::ControllerError>(milliseconds(5), 1);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->error, 1U);
}

TEST_F(Master, CurrentLimitHolds) {
  Build(Axis(1));
  Send(1, can::SetLimits{1000.0, 2.0});
  CloseLoop(1);
  Send(1, can::SetInputTorque{10.0});
  Pass(milliseconds(3));
  EXPECT_NEAR(rotors_.torque_Nm[0], 2.0 * 0.0159155, 1e-9);
}

TEST_F(Master, NonFiniteSetpointsMoveNothing) {
  Build(Axis(1));
  CloseLoop(1);
  Send(1, can::SetInputTorque{std::nan("")});
  Pass(milliseconds(20));
  EXPECT_EQ(rotors_.torque_Nm[0], 0.0);
  Send(1, can::SetControllerMode{can::ControlMode::kPosition, can::InputMode::kPassthrough});
  Send(1, can::SetInputPos{std::numeric_limits<double>::infinity(), 0, 0});
  Pass(milliseconds(200));
  EXPECT_LT(std::abs(rotors_.angle_rad[0]), 1.0);
}

TEST_F(Master, PositionModeStartsWhereTheMotorIs) {
  rotors_.angle_rad[0] = 20.0;
  Build(Axis(1));
  Send(1, can::SetInputPos{-3.0, 0, 0});  // before closed loop: forgotten
  Send(1, can::SetControllerMode{can::ControlMode::kPosition, can::InputMode::kPassthrough});
  Send(1, can::SetAxisState{AxisState::kClosedLoopControl});
  Pass(milliseconds(200));
  EXPECT_NEAR(rotors_.angle_rad[0], 20.0, 1e-3);
  Send(1, can::SetInputPos{4.0, 0, 0});
  Pass(milliseconds(2000));
  EXPECT_NEAR(rotors_.angle_rad[0], 4.0 * types::kTwoPi, 0.01);
}

TEST_F(Master, RebootIsSilentAndComesBackIdleWithoutErrors) {
  Build(Axis(1));
  axes_->SetAxisError(0, can::axis_error::kOverTemp);
  Send(1, can::Reboot{});
  Pass(milliseconds(3));
  EXPECT_FALSE(Await<can::EncoderEstimates>(milliseconds(250), 1));
  const auto heartbeat = Await<can::Heartbeat>(milliseconds(200), 1);
  ASSERT_TRUE(heartbeat);
  EXPECT_EQ(heartbeat->axis_error, 0U);
  EXPECT_EQ(heartbeat->axis_state, AxisState::kIdle);
}

TEST_F(Master, NodeNumberCanBeChanged) {
  Build(Axis(1));
  Send(1, can::SetAxisNodeId{7});
  Pass(milliseconds(3));
  EXPECT_TRUE(Await<can::EncoderEstimates>(milliseconds(20), 7));
  Send(7, can::SetAxisNodeId{64});  // none
  Pass(milliseconds(3));
  EXPECT_TRUE(Await<can::EncoderEstimates>(milliseconds(20), 7));
}

TEST_F(Master, UnknownStateIsAnError) {
  Build(Axis(1));
  Send(1, can::SetAxisState{static_cast<AxisState>(99)});
  Pass(milliseconds(3));
  EXPECT_EQ(axes_->axis_error(0), can::axis_error::kInvalidState);
}

TEST_F(Master, OldFirmwareAnswersOnlyRemoteFramesAndMeasuresNoCurrent) {
  firmware_ = can::Firmware::k0_5_4;
  AxisConfig config = Axis(1);
  config.firmware = firmware_;
  config.rates.encoder_ms = 0;
  Build(config);
  Pass(milliseconds(2));
  Frame empty;
  empty.id = can::Identifier(1, Command::kGetIq);
  ASSERT_EQ(master_->Send(empty), can::SendStatus::kOk);
  EXPECT_FALSE(Await<can::Iq>(milliseconds(5), 1));
  ASSERT_EQ(master_->Send(can::EncodeRequest(1, Command::kGetIq)), can::SendStatus::kOk);
  EXPECT_TRUE(Await<can::Iq>(milliseconds(5), 1));
  ASSERT_EQ(master_->Send(can::EncodeRequest(1, Command::kGetControllerError)),
            can::SendStatus::kOk);
  EXPECT_FALSE(Await<can::ControllerError>(milliseconds(5), 1));
}

TEST_F(Master, SensorNodeSendsWhatThePlantMeasures) {
  rotors_.angle_rad[0] = 50.0;
  rotors_.pressure_bar[0] = 4.125;
  rotors_.temperature_degC[0] = 36.6;
  Build(Axis(1), true);
  can::Received received;
  std::optional<can::OutputEncoder> encoder;
  std::optional<can::JointSensors> sensors;
  int sequence_steps = 0;
  std::optional<std::uint8_t> last;
  while (bus_.now_ns() < 100 * kMs_ns) {
    if (!master_->Receive(milliseconds(1), &received) || can::AddressOf(received.frame)->node != 32)
      continue;
    if (const auto m = can::DecodeOutputEncoder(received.frame)) {
      if (last) {
        EXPECT_EQ(m->sequence, static_cast<std::uint8_t>(*last + 1));
        ++sequence_steps;
      }
      last = m->sequence;
      encoder = m;
    }
    if (const auto m = can::DecodeJointSensors(received.frame)) sensors = m;
  }
  ASSERT_TRUE(encoder && sensors);
  EXPECT_NEAR(encoder->angle_rad, 0.5, 1e-6);
  EXPECT_TRUE(encoder->encoder_valid);
  EXPECT_NEAR(sensors->chamber_pressure_bar, 4.125, 1e-9);
  EXPECT_NEAR(sensors->motor_temperature_degC, 36.6, 1e-9);
  EXPECT_GT(sequence_steps, 20);
}

TEST_F(Master, ValvesFollowTheirCommandAndShutWhenItStops) {
  Build(Axis(1), true);
  ASSERT_EQ(master_->Send(can::Encode(32, can::ValveCommand{true, true, false, 0, 60})),
            can::SendStatus::kOk);
  Pass(milliseconds(10));
  EXPECT_TRUE(rotors_.last_command.valve_open[0]);
  EXPECT_TRUE(rotors_.last_command.compressor_on[0]);
  Pass(milliseconds(60));
  EXPECT_FALSE(rotors_.last_command.valve_open[0]);
  EXPECT_FALSE(rotors_.last_command.compressor_on[0]);
}

TEST_F(Master, RandomFramesNeverMoveAnIdleAxisNorAnotherOne) {
  VirtualAxesConfig config;
  config.axes.push_back(Axis(2));
  config.axes.back().gear_ratio = 100.0;
  Build(config);
  std::mt19937 random(17);
  for (int i = 0; i < 20000; ++i) {
    Frame frame;
    do {
      frame.id = random() & can::kMaxStandardId;
    } while (frame.id >> 5 == 2 &&
             (frame.id & 31) == static_cast<unsigned>(Command::kSetAxisState));
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t k = 0; k < frame.length; ++k)
      frame.data[k] = static_cast<std::uint8_t>(random());
    (void)master_->Send(frame);
    Pass(milliseconds(1));
  }
  EXPECT_EQ(rotors_.angle_rad[0], 0.0);
}

TEST_F(Master, LongPauseIsNotCaughtUpInABurst) {
  Build(Axis(1));
  const std::uint64_t before = axes_->steps();
  axes_->Run(bus_.now_ns() + 10'000 * kMs_ns);
  EXPECT_LE(axes_->steps() - before, 60U);
}

TEST_F(Master, APlantThatIsHeldMovesOnceAllAxesHaveBeenDrivenForItsTime) {
  VirtualAxesConfig config;
  config.axes = {Axis(3), Axis(4)};  // two motors of one joint, which moves by either
  config.hold_start_s = 0.2;
  Build(config);
  rotors_.angle_rad[0] = 0.0;
  rotors_.velocity_rad_s[0] = 1.0;
  CloseLoop(3);
  Pass(milliseconds(1000));
  EXPECT_TRUE(axes_->held()) << "one of two";
  EXPECT_EQ(rotors_.angle_rad[0], 0.0);
  CloseLoop(4);
  Pass(milliseconds(150));
  Send(3, can::SetAxisState{AxisState::kIdle});
  Pass(milliseconds(10));
  CloseLoop(3);
  Pass(milliseconds(150));
  EXPECT_TRUE(axes_->held()) << "its time begins anew";
  EXPECT_EQ(rotors_.angle_rad[0], 0.0);
  Pass(milliseconds(60));
  EXPECT_FALSE(axes_->held());
  EXPECT_GT(rotors_.angle_rad[0], 0.0);
  Send(3, can::SetAxisState{AxisState::kIdle});
  Pass(milliseconds(10));
  EXPECT_FALSE(axes_->held()) << "a robot that falls falls";
}

TEST(VirtualAxesConfig, BadValuesAreRefused) {
  test::Rotors rotors(1);
  can::MemoryBus bus({});
  const auto end = bus.Join("axes");
  const auto build = [&](const VirtualAxesConfig& config) {
    VirtualAxes(config, rotors, {end.get()});
  };
  EXPECT_THROW(build({}), std::invalid_argument);
  VirtualAxesConfig config;
  config.axes.resize(1);
  EXPECT_NO_THROW(build(config));
  config.axes[0].joint = 1;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.axes[0] = {};
  config.axes[0].node = 64;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.axes[0] = {};
  config.axes[0].bus = 1;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.axes[0] = {};
  config.axes[0].direction = 0;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.axes[0] = {};
  config.axes[0].current_limit_A = 0.0;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.axes[0] = {};
  config.axes.push_back(config.axes[0]);
  EXPECT_THROW(build(config), std::invalid_argument) << "one node number twice";
  config.axes.pop_back();
  config.step_s = 0.0;
  EXPECT_THROW(build(config), std::invalid_argument);
  config.step_s = 0.001;
  config.hold_start_s = std::nan("");
  EXPECT_THROW(build(config), std::invalid_argument);
  config.hold_start_s = 0.0;
  config.body_nodes = {{.node = 40, .part = can::BodyPart::kLeftFoot}};
  EXPECT_NO_THROW(build(config));
  config.body_nodes[0].force_noise_m_s2 = 0.1;
  EXPECT_THROW(build(config), std::invalid_argument) << "of a foot";
  config.body_nodes = {{.node = 40, .part = can::BodyPart::kImu, .rate_noise_rad_s = -0.1}};
  EXPECT_THROW(build(config), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::virtual_axes

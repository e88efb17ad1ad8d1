// What fuzzing found, a minimal case each.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "bridge/can/candump.h"
#include "components/base/types/control_mode.h"
#include "tests/fuzz/watched_plant.h"

namespace sinew::fuzz {
namespace {

using types::ControlMode;
using types::FaultCause;

// One joint with a sensor node, on its bus.
struct OneJoint {
  OneJoint()
      : config(FuzzedRobot(1)),
        robot(config),
        bus(0, now_ns, nullptr),
        other(1, now_ns, nullptr),
        plant(config, {&bus, &other}) {
    robot.amplitude_rad = 0.1;
    bus.on_wait = [this] { SendMessages(true); };
    plant.Reset(&sensors);
    bus.on_wait = nullptr;
  }
  void SendMessages(bool all) {
    robot.SendMessages(0, 1e-9 * static_cast<double>(now_ns), all, &bus.feed);
  }
  void Act() {
    now_ns += kPeriod_ns;
    SendMessages(false);
    plant.Act(command, kPeriod_s);
    for (const can::Frame& frame : bus.sent) robot.Take(0, frame);
    bus.sent.clear();
  }
  void Step() {
    plant.Step(command, kPeriod_s, &sensors);
    bus.Clear();
  }
  void Cycle() {
    Act();
    Step();
  }

  bridge::BridgeConfig config;
  LiveRobot robot;
  std::int64_t now_ns = 1'000'000'000;
  FedBus bus;
  FedBus other;
  bridge::CanPlant plant;
  provider::PlantCommand command;
  provider::PlantSensors sensors;
};

// A controller with motor_error_rate_ms set, or one that repeats itself: every answer was appended
// to the message.
TEST(Found, RepeatedAnswersAboutAnErrorDoNotMakeTheFaultsMessageGrow) {
  OneJoint joint;
  for (int i = 0; i < 10; ++i) joint.Cycle();
  const auto firmware = joint.config.joints[0].firmware;
  joint.bus.feed.push_back(can::Encode(
      1, can::Heartbeat{can::axis_error::kMotorFailed, can::AxisState::kIdle}, firmware));
  joint.Cycle();
  ASSERT_EQ(joint.plant.fault(0), FaultCause::kAxisError);
  for (int i = 0; i < 1000; ++i) {
    joint.bus.feed.push_back(can::Encode(1, can::MotorError{0x10}, firmware));
    joint.bus.feed.push_back(can::Encode(1, can::EncoderError{0x4}, firmware));
    joint.Cycle();
  }
  EXPECT_LT(joint.sensors.message.size(), 512U);
}

// Reported for up to estimate_timeout_s as a valid measurement, and used for the position limits.
TEST(Found, AngleThatTheSensorNodeCallsInvalidIsNotReportedAsAMeasurement) {
  OneJoint joint;
  for (int i = 0; i < 10; ++i) joint.Cycle();
  ASSERT_TRUE(joint.sensors.valid[0]);
  const double before_rad = joint.sensors.position_rad[0];
  can::OutputEncoder broken;
  broken.angle_rad = 100.0;
  broken.sequence = 200;
  broken.encoder_valid = false;
  joint.bus.feed.push_back(can::Encode(33, broken));
  joint.now_ns += kPeriod_ns;
  joint.Step();
  EXPECT_TRUE(!joint.sensors.valid[0] || std::abs(joint.sensors.position_rad[0] - before_rad) < 0.1)
      << joint.sensors.position_rad[0] << " rad, valid";
}

// The provider takes operator commands between Act and Step: a reset there must not clear a fault
// that was not reported, or the joint arms again by itself.
TEST(Found, FaultThatRoseInActIsReportedEvenWhenAResetComesBeforeTheStep) {
  OneJoint joint;
  joint.command.mode[0] = ControlMode::kTorque;
  joint.command.motor_torque_Nm[0] = 0.01;
  for (int i = 0; i < 30; ++i) joint.Cycle();
  ASSERT_EQ(joint.plant.fault(0), FaultCause::kNone) << joint.sensors.message;
  joint.now_ns += kPeriod_ns;
  joint.bus.feed.push_back(
      can::Encode(1, can::EncoderEstimates{500.0, 0.0}, joint.config.joints[0].firmware));
  joint.plant.Act(joint.command, kPeriod_s);
  ASSERT_EQ(joint.plant.fault(0), FaultCause::kEncoderJump);
  joint.plant.ClearFault();
  joint.Step();
  EXPECT_TRUE(joint.sensors.joint_fault[0].active());
}

TEST(Found, MinusZeroIsNoTimeOfALog) {
  EXPECT_TRUE(can::ParseCandump("(0.000000) can0 123#00"));
  EXPECT_FALSE(can::ParseCandump("(-0.000000) can0 123#00"));
  EXPECT_FALSE(can::ParseCandump("(0.-00000) can0 123#00"));
}

}  // namespace
}  // namespace sinew::fuzz

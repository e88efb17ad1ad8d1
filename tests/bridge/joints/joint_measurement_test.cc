// Frames of a joint's nodes to its measurement: conventions, jumps, frames that cannot be read.
#include "bridge/joints/joint_measurement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>

#include "bridge/joints/faults.h"
#include "components/base/types/angle.h"
#include "tests/bridge/joints/one_joint.h"

namespace sinew::bridge {
namespace {

using ::testing::HasSubstr;
using types::FaultCause;

JointConfig Joint(int direction = 1, bool output = true) {
  JointConfig joint = Knee();
  joint.direction = direction;
  joint.zero_rev = 2.5;
  joint.output = OutputNode{35, -direction, 0.25};
  if (!output) joint.output.reset();
  return joint;
}

template <class Message>
can::Received At(std::int64_t stamp_ns, const Message& message) {
  return {can::Encode(3, message), stamp_ns};
}
can::Received Output(std::int64_t stamp_ns, double angle_rad, std::uint8_t sequence, bool valid) {
  can::OutputEncoder m;
  m.angle_rad = angle_rad;
  m.sequence = sequence;
  m.encoder_valid = valid;
  m.valve_open = !valid;
  return {can::Encode(35, m), stamp_ns};
}

TEST(JointMeasurement, AnglesFollowTheConventionInBothDirections) {
  for (const int direction : {1, -1}) {
    const JointConfig config = Joint(direction);
    JointMeasurement m(config);
    m.home_rev = 4.0;
    m.estimates = {2.5 + 4.0 + direction * 0.5, direction * 0.25};
    m.output.angle_rad = 0.25 - direction * 0.1;
    m.output.velocity_rad_s = -direction * 0.2;
    EXPECT_DOUBLE_EQ(m.motor_position_rad(), 0.5 * types::kTwoPi);
    EXPECT_DOUBLE_EQ(m.motor_velocity_rad_s(), 0.25 * types::kTwoPi);
    EXPECT_DOUBLE_EQ(m.motor_position_at_output_rad(), 0.005 * types::kTwoPi);
    EXPECT_NEAR(m.position_rad(), 0.1, 1e-15);
    EXPECT_NEAR(m.velocity_rad_s(), 0.2, 1e-15);
    EXPECT_NEAR(m.Revolutions(m.motor_position_at_output_rad()), m.estimates.position_rev, 1e-12)
        << "the inverse";
  }
}

// Firmware 0.5.6 leaves these bits out of axis_error.
TEST(JointMeasurement, FlagsOfTheHeartbeatAreErrors) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  const struct {
    bool can::Heartbeat::*flag;
    std::uint32_t error;
  } kFlags[] = {{&can::Heartbeat::motor_error, can::axis_error::kMotorFailed},
                {&can::Heartbeat::encoder_error, can::axis_error::kEncoderFailed},
                {&can::Heartbeat::controller_error, can::axis_error::kControllerFailed}};
  std::int64_t now_ns = 1;
  for (const auto& [flag, error] : kFlags) {
    can::Heartbeat heartbeat;
    heartbeat.axis_state = can::AxisState::kClosedLoopControl;
    heartbeat.*flag = true;
    EXPECT_EQ(m.TakeFromAxis(At(++now_ns, heartbeat), &fault), Taken::kStored);
    EXPECT_EQ(m.heartbeat.axis_error, error);
    m.ClearErrors(now_ns + 5);
    m.TakeFromAxis(At(now_ns + 5, heartbeat), &fault);
    EXPECT_EQ(m.heartbeat.axis_error, 0u) << "from before they were cleared";
    now_ns += 10;
  }
}

TEST(JointMeasurement, WithoutASensorNodeTheOutputIsTheMotors) {
  const JointConfig config = Joint(-1, false);
  JointMeasurement m(config);
  m.estimates = {3.5, -2.0};
  EXPECT_DOUBLE_EQ(m.position_rad(), -0.01 * types::kTwoPi);
  EXPECT_DOUBLE_EQ(m.velocity_rad_s(), 0.02 * types::kTwoPi);
}

TEST(JointMeasurement, EveryMessageIsStoredWithItsStamp) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  EXPECT_EQ(m.TakeFromAxis(At(10, can::Heartbeat{0, can::AxisState::kIdle}), &fault),
            Taken::kStored);
  EXPECT_EQ(m.TakeFromAxis(At(11, can::EncoderEstimates{1.5, 0.5}), &fault), Taken::kEstimates);
  EXPECT_EQ(m.TakeFromAxis(At(12, can::Iq{1.0, 2.0}), &fault), Taken::kIq);
  EXPECT_EQ(m.TakeFromNode(Output(13, 0.5, 1, true), &fault), Taken::kStored);
  EXPECT_EQ(m.TakeFromNode({can::Encode(35, can::JointSensors{4.0, 6.0, 12.0, 31.0}), 14}, &fault),
            Taken::kStored);
  EXPECT_EQ(m.heartbeat_ns, 10);
  EXPECT_EQ(m.estimates_ns, 11);
  EXPECT_EQ(m.estimates.position_rev, 1.5);
  EXPECT_EQ(m.iq_ns, 12);
  EXPECT_EQ(m.iq_A, 2.0) << "the measured one";
  EXPECT_EQ(m.output_ns, 13);
  EXPECT_EQ(m.sensors_ns, 14);
  EXPECT_EQ(m.sensors.load_force_N, 12.0);
  EXPECT_FALSE(fault.active());
}

TEST(JointMeasurement, TheOldestCountsAndWithoutASensorNodeOnlyTheMotors) {
  const JointConfig with = Joint(), without = Joint(1, false);
  JointMeasurement m(with);
  m.estimates_ns = 4;
  m.iq_ns = 3;
  m.output_ns = 2;
  m.sensors_ns = 5;
  EXPECT_EQ(m.oldest_ns(), 2);
  m.sensors_ns = 1;
  EXPECT_EQ(m.oldest_ns(), 1);
  m.config = &without;
  EXPECT_EQ(m.oldest_ns(), 3);
}

TEST(JointMeasurement, NamesWhatIsMissing) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  EXPECT_EQ(m.Missing(), "no heartbeat of axis node 3");
  m.heartbeat_ns = 1;
  EXPECT_EQ(m.Missing(), "no encoder estimates of axis node 3");
  m.estimates_ns = 1;
  EXPECT_EQ(m.Missing(), "nothing from sensor node 35");
  m.output_ns = 1;
  EXPECT_EQ(m.Missing(), "nothing from sensor node 35");
  m.sensors_ns = 1;
  EXPECT_EQ(m.Missing(), "");
}

TEST(JointMeasurement, FramesThatCannotBeReadChangeNothing) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  const auto cut = [](can::Received received) {
    received.frame.length = 3;
    return received;
  };
  const double nan = std::nan(""), inf = std::numeric_limits<double>::infinity();
  for (const can::Received& received :
       {cut(At(1, can::Heartbeat{})), cut(At(1, can::EncoderEstimates{})), cut(At(1, can::Iq{})),
        cut(At(1, can::MotorError{})), cut(At(1, can::EncoderError{})),
        cut(At(1, can::ControllerError{})), At(1, can::EncoderEstimates{nan, 0.0}),
        At(1, can::EncoderEstimates{0.0, inf}), At(1, can::Iq{0.0, nan})}) {
    EXPECT_EQ(m.TakeFromAxis(received, &fault), Taken::kMalformed) << received.frame.id;
  }
  EXPECT_EQ(m.TakeFromNode(cut(Output(1, 0.0, 0, true)), &fault), Taken::kMalformed);
  EXPECT_EQ(m.TakeFromNode(cut({can::Encode(35, can::JointSensors{}), 1}), &fault),
            Taken::kMalformed);
  EXPECT_EQ(m.TakeFromAxis(At(1, can::BusVoltageCurrent{}), &fault), Taken::kUnused);
  EXPECT_EQ(m.TakeFromNode({can::Encode(35, can::NodeHeartbeat{}), 1}, &fault), Taken::kUnused);
  EXPECT_EQ(m.heartbeat_ns + m.estimates_ns + m.iq_ns + m.output_ns + m.sensors_ns, 0);
  EXPECT_FALSE(fault.active());
}

TEST(JointMeasurement, ErrorsOfAHeartbeatFromBeforeTheClearingAreIgnored) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  const can::Heartbeat failed{can::axis_error::kMotorFailed, can::AxisState::kIdle};
  (void)m.TakeFromAxis(At(10, failed), &fault);
  EXPECT_NE(m.heartbeat.axis_error, 0U);
  m.ClearErrors(20);
  EXPECT_EQ(m.heartbeat.axis_error, 0U);
  (void)m.TakeFromAxis(At(20, failed), &fault);
  EXPECT_EQ(m.heartbeat.axis_error, 0U);
  EXPECT_EQ(m.heartbeat_ns, 20) << "it is a sign of life all the same";
  (void)m.TakeFromAxis(At(21, failed), &fault);
  EXPECT_NE(m.heartbeat.axis_error, 0U);
}

TEST(JointMeasurement, ErrorCodesAreAppendedToTheAxisError) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  fault.Fail(FaultCause::kAxisError, "0x40");
  EXPECT_EQ(m.TakeFromAxis(At(1, can::MotorError{0x10}), &fault), Taken::kStored);
  EXPECT_EQ(m.TakeFromAxis(At(1, can::EncoderError{0x4}), &fault), Taken::kStored);
  EXPECT_EQ(m.TakeFromAxis(At(1, can::ControllerError{0x2}), &fault), Taken::kStored);
  EXPECT_THAT(fault.text(),
              HasSubstr("axis error: 0x40, motor 0x10, encoder 0x4, controller 0x2: "));
}

// 1.5 * 2 rad/s * 100 / 2 pi = 47.7 rev/s: 0.19 in 4 ms, and a quarter.
TEST(JointMeasurement, AJumpOfTheEstimatesIsAFault) {
  const JointConfig config = Joint();
  for (const auto& [step_rev, jump] : {std::pair{0.43, false}, {-0.43, false}, {0.45, true}}) {
    JointMeasurement m(config);
    FaultLatch fault(config);
    m.TakeEstimates({9.0, 0.0}, 1'000 * kMs_ns, &fault);
    EXPECT_FALSE(fault.active()) << "the first may be anywhere";
    m.TakeEstimates({9.0 + step_rev, 0.0}, 1'004 * kMs_ns, &fault);
    EXPECT_EQ(fault.cause() == FaultCause::kEncoderJump, jump) << step_rev;
    EXPECT_EQ(m.estimates.position_rev, 9.0 + step_rev) << "stored all the same";
    if (jump) {
      EXPECT_THAT(fault.text(), HasSubstr("motor encoder jump: 0.45 rev, limit 0.44 rev: look"));
    }
  }
}

TEST(JointMeasurement, AFastMotorMayHaveWaitedForTheBus) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  m.TakeEstimates({0.0, 60.0}, 1'000 * kMs_ns, &fault);
  m.TakeEstimates({0.84, 60.0}, 1'000 * kMs_ns, &fault);  // 60 rev/s * 10 ms, and a quarter
  EXPECT_FALSE(fault.active()) << fault.text();
  m.TakeEstimates({1.70, 60.0}, 1'000 * kMs_ns, &fault);
  EXPECT_EQ(fault.cause(), FaultCause::kEncoderJump);
}

TEST(JointMeasurement, AnInvalidOutputAngleKeepsTheLastOneAndTakesTheRelays) {
  const JointConfig config = Joint();
  JointMeasurement m(config);
  FaultLatch fault(config);
  (void)m.TakeFromNode(Output(1, 0.5, 1, true), &fault);
  (void)m.TakeFromNode(Output(2, 0.9, 2, false), &fault);
  EXPECT_EQ(m.output.angle_rad, 0.5);
  EXPECT_TRUE(m.output.valve_open);
  EXPECT_EQ(m.output_ns, 1) << "no measurement";
  (void)m.TakeFromNode(Output(3, 0.9, 2, true), &fault);
  EXPECT_EQ(m.output_ns, 1) << "a sequence number that stands still";
  (void)m.TakeFromNode(Output(4, 0.9, 3, true), &fault);
  EXPECT_EQ(m.output_ns, 4);
  EXPECT_NEAR(m.output.angle_rad, 0.9, 1e-9);  // steps of 1e-6 on the wire
}

// 2 rad/s, 10 ms of waiting and 4 ms between the frames: 1.5 * 2 * 0.014 = 0.042, play 0.04 and
// 0.0115.
TEST(JointMeasurement, AnOutputAngleThatStepsFurtherThanTheJointCanTurnIsAJump) {
  JointConfig config = Joint();
  config.limits.velocity_rad_s = 2.0;
  config.zero_check = ZeroCheck{0.04, 0.006};
  for (const double step_rad : {0.093, -0.093, 0.094, -0.094}) {
    JointMeasurement m(config);
    FaultLatch fault(config);
    (void)m.TakeFromNode(Output(1 * kMs_ns, 0.5, 1, true), &fault);
    (void)m.TakeFromNode(Output(5 * kMs_ns, 0.5 + step_rad, 2, true), &fault);
    EXPECT_EQ(fault.cause(),
              std::abs(step_rad) > 0.0935 ? FaultCause::kOutputJump : FaultCause::kNone)
        << step_rad << " rad: " << fault.text();
  }
}

}  // namespace
}  // namespace sinew::bridge

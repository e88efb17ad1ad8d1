// The frames of both exchanges, read back from the outbox.
#include "bridge/joints/exchange.h"

#include <gtest/gtest.h>

#include <vector>

#include "components/base/types/angle.h"
#include "tests/bridge/joints/one_joint.h"
#include "tests/bridge/joints/plant_bench.h"

namespace sinew::bridge {
namespace {

JointConfig KneeOfTheSecondBus() {
  JointConfig joint = Knee();
  joint.bus = 1;
  return joint;
}

class Exchanges : public ::testing::Test {
 protected:
  Exchanges()
      : config(KneeOfTheSecondBus()),
        outbox(2),
        link(48),
        direct(config, true, &outbox),
        gateway(config, true, &outbox, &link, 5),
        measured(config) {
    measured.estimates.position_rev = 1.25;
  }
  // What was posted since the last call.
  std::vector<can::Frame> Posted() {
    Deaf buses[2];
    const std::vector<can::Frame> frames(outbox.frames(1).begin(), outbox.frames(1).end());
    EXPECT_TRUE(outbox.frames(0).empty());
    can::Transport* const transports[] = {&buses[0], &buses[1]};
    outbox.Flush(transports);
    return frames;
  }
  double Reference() {
    can::CompactReferences references;
    for (const can::Frame& frame : link.References()) {
      EXPECT_TRUE(can::DecodeReferences(48, frame, &references));
    }
    return references.position_turns[5];
  }

  JointConfig config;
  FrameOutbox outbox;
  CompactLink link;
  DirectExchange direct;
  GatewayExchange gateway;
  JointMeasurement measured;
};

template <class Message>
Message Only(const std::vector<can::Frame>& frames) {
  EXPECT_EQ(frames.size(), 1U);
  const auto message = frames.empty() ? std::nullopt : can::Decode<Message>(frames[0]);
  EXPECT_TRUE(message.has_value());
  return message.value_or(Message{});
}

TEST_F(Exchanges, OutboxSendsToTheBusesInOrderAndIsEmptyThen) {
  Deaf buses[2];
  std::vector<can::Frame> sent;
  for (Deaf& bus : buses) bus.on_send = [&](const can::Frame& frame) { sent.push_back(frame); };
  const can::Frame first = can::Encode(1, can::Reboot{}), second = can::Encode(2, can::Reboot{});
  outbox.Post(1, second);
  outbox.Post(0, first);
  outbox.Post(1, first);
  can::Transport* const transports[] = {&buses[0], &buses[1]};
  outbox.Flush(transports);
  ASSERT_EQ(sent.size(), 3U);
  EXPECT_EQ(sent[0], first);
  EXPECT_EQ(sent[1], second);
  EXPECT_EQ(sent[2], first);
  outbox.Flush(transports);
  EXPECT_EQ(sent.size(), 3U);
}

TEST_F(Exchanges, ClosedLoopIsModeLimitsAndState) {
  direct.RequestClosedLoop(ControlMode::kVelocity, measured);
  const std::vector<can::Frame> frames = Posted();
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(can::Decode<can::SetControllerMode>(frames[0])->control_mode,
            can::ControlMode::kVelocity);
  EXPECT_NEAR(can::Decode<can::SetLimits>(frames[1])->velocity_limit_rev_s,
              2.0 * 100.0 / types::kTwoPi, 1e-6);
  EXPECT_EQ(can::Decode<can::SetLimits>(frames[1])->current_limit_A, 25.0);
  EXPECT_EQ(can::Decode<can::SetAxisState>(frames[2])->state, can::AxisState::kClosedLoopControl);
}

// A bus that is full for each frame of a group in turn.
TEST_F(Exchanges, ANodeThatHasLostAFrameIsNotSetInMotionInThatCycle) {
  Deaf buses[2];
  can::Transport* const transports[] = {&buses[0], &buses[1]};
  std::vector<can::Frame> sent;
  buses[1].on_send = [&](const can::Frame& frame) { sent.push_back(frame); };
  for (int lost = 0; lost < 4; ++lost) {
    sent.clear();
    int place = 0;
    buses[1].loses = [&](const can::Frame&) { return place++ == lost; };
    direct.RequestClosedLoop(ControlMode::kPosition, measured);
    direct.RequestData(can::Command::kGetIq);
    const can::Frame other = can::Encode(config.node + 1, can::SetInputTorque{0.1});
    outbox.Post(1, other);
    direct.RequestIdle();
    outbox.Flush(transports);
    // Those before it, the request, the other node's, and what stops this one.
    ASSERT_EQ(sent.size(), static_cast<std::size_t>(lost) + 3) << lost;
    EXPECT_TRUE(sent[static_cast<std::size_t>(lost)].remote);
    EXPECT_EQ(sent[static_cast<std::size_t>(lost) + 1], other);
    EXPECT_EQ(can::Decode<can::SetAxisState>(sent.back())->state, can::AxisState::kIdle);
    for (const can::Frame& frame : sent) {
      const auto state = can::Decode<can::SetAxisState>(frame);
      EXPECT_FALSE(state && state->state == can::AxisState::kClosedLoopControl) << lost;
    }
  }
}

TEST_F(Exchanges, PositionControlIsPrecededByTheMeasuredPosition) {
  for (JointExchange* exchange :
       {static_cast<JointExchange*>(&direct), static_cast<JointExchange*>(&gateway)}) {
    exchange->RequestClosedLoop(ControlMode::kPosition, measured);
    const std::vector<can::Frame> frames = Posted();
    ASSERT_EQ(frames.size(), 4U);
    EXPECT_EQ(can::Decode<can::SetInputPos>(frames[0])->position_rev, 1.25);
    EXPECT_EQ(can::Decode<can::SetControllerMode>(frames[1])->control_mode,
              can::ControlMode::kPosition);
  }
}

TEST_F(Exchanges, IdleModeAndDataAreRequestedFromTheJointsNode) {
  direct.RequestIdle();
  EXPECT_EQ(Only<can::SetAxisState>(Posted()).state, can::AxisState::kIdle);
  direct.RequestMode(ControlMode::kTorque);
  EXPECT_EQ(Only<can::SetControllerMode>(Posted()).control_mode, can::ControlMode::kTorque);
  direct.RequestData(can::Command::kGetIq);
  const std::vector<can::Frame> frames = Posted();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(frames[0].remote);
  EXPECT_EQ(frames[0].id, can::Identifier(3, can::Command::kGetIq));
}

TEST_F(Exchanges, ShortFramesLeaveTheUnusedBytesOut) {
  direct.Send(can::SetInputTorque{0.5});
  EXPECT_EQ(Posted().at(0).length, 4);
  DirectExchange full(config, false, &outbox);
  full.Send(can::SetInputTorque{0.5});
  EXPECT_EQ(Posted().at(0).length, 8);
}

TEST_F(Exchanges, DirectPositionsAreSetpointsWithFeedForward) {
  EXPECT_TRUE(direct.is_polled());
  EXPECT_TRUE(direct.SendPosition(1e4, 0.5));
  const auto setpoint = Only<can::SetInputPos>(Posted());
  EXPECT_EQ(setpoint.position_rev, 1e4);
  EXPECT_NEAR(setpoint.velocity_feed_forward_rev_s, 0.5, 1e-9);
}

TEST_F(Exchanges, DirectNeutralSetpointsMoveNothingInTheirMode) {
  EXPECT_TRUE(direct.SendNeutral(ControlMode::kIdle, measured));
  EXPECT_EQ(Only<can::SetInputTorque>(Posted()).torque_Nm, 0.0);
  EXPECT_TRUE(direct.SendNeutral(ControlMode::kTorque, measured));
  EXPECT_EQ(Only<can::SetInputTorque>(Posted()).torque_Nm, 0.0);
  EXPECT_TRUE(direct.SendNeutral(ControlMode::kPosition, measured));
  EXPECT_EQ(Only<can::SetInputPos>(Posted()).position_rev, 1.25);
  EXPECT_TRUE(direct.SendNeutral(ControlMode::kVelocity, measured));
  EXPECT_EQ(Only<can::SetInputVel>(Posted()).velocity_rev_s, 0.0);
}

TEST_F(Exchanges, GatewayPositionsAreReferencesAndNoFrames) {
  EXPECT_FALSE(gateway.is_polled());
  EXPECT_TRUE(gateway.SendPosition(12.5, 0.5));
  EXPECT_TRUE(Posted().empty());
  EXPECT_NEAR(Reference(), 12.5, 1e-9);
  EXPECT_FALSE(gateway.SendPosition(328.0, 0.0)) << "beyond its field";
  EXPECT_NEAR(Reference(), 12.5, 1e-9) << "unchanged";
}

TEST_F(Exchanges, GatewayNeutralIsAReferenceAndASetpointWhereThatDoesNotSuffice) {
  EXPECT_TRUE(gateway.SendNeutral(ControlMode::kPosition, measured));
  EXPECT_TRUE(Posted().empty());
  EXPECT_NEAR(Reference(), 1.25, 1e-9);
  EXPECT_TRUE(gateway.SendNeutral(ControlMode::kTorque, measured));
  EXPECT_EQ(Only<can::SetInputTorque>(Posted()).torque_Nm, 0.0);
  EXPECT_TRUE(gateway.SendNeutral(ControlMode::kVelocity, measured));
  EXPECT_EQ(Only<can::SetInputVel>(Posted()).velocity_rev_s, 0.0);
  EXPECT_TRUE(gateway.SendNeutral(ControlMode::kIdle, measured));
  EXPECT_TRUE(Posted().empty()) << "the axis is idle";
  measured.heartbeat.axis_state = can::AxisState::kClosedLoopControl;
  EXPECT_TRUE(gateway.SendNeutral(ControlMode::kIdle, measured));
  EXPECT_EQ(Only<can::SetInputTorque>(Posted()).torque_Nm, 0.0) << "it is not yet";
}

TEST_F(Exchanges, AMeasuredPositionBeyondTheFieldIsReportedAndTheSetpointSentAllTheSame) {
  measured.estimates.position_rev = 400.0;
  EXPECT_FALSE(gateway.SendNeutral(ControlMode::kTorque, measured));
  EXPECT_EQ(Only<can::SetInputTorque>(Posted()).torque_Nm, 0.0);
  EXPECT_EQ(Reference(), 0.0);
}

}  // namespace
}  // namespace sinew::bridge

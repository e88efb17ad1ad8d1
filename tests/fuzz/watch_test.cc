// The watch itself: it must see every kind of frame that may not leave, else the fuzzing proves
// nothing. And the harness must reach joints that move.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "components/base/types/control_mode.h"
#include "tests/fuzz/watched_plant.h"

namespace sinew::fuzz {
namespace {

using types::ControlMode;

// A robot of four joints in motion; joint 3 is idle. Joints 0 and 1 are on bus 0 with nodes 1 and
// 2, joints 2 and 3 on bus 1 with the same ones.
class Watched : public ::testing::Test, protected WatchedPlant {
 protected:
  Watched() : Watched(false) {}
  explicit Watched(bool gateway) : WatchedPlant(FuzzedRobot(4, gateway)) {
    robot.amplitude_rad = 0.5;
    Start();
    command.mode = {ControlMode::kTorque, ControlMode::kPosition, ControlMode::kVelocity,
                    ControlMode::kIdle};
    command.motor_torque_Nm[0] = 0.05;
    command.position_rad[1] = 0.2;
    command.velocity_rad_s[2] = 0.5;
    command.valve_open[0] = true;
    for (int i = 0; i < 30; ++i) NextCycle();
  }

  void NextCycle(const std::function<void()>& inside = {}) {
    Advance();
    SendMessages(false);
    (void)Cycle(inside);
  }
  // The rule that one more frame in a cycle breaks; empty when none.
  template <class Message>
  std::string Breaks(int bus, int node, const Message& message) {
    const can::Frame frame = can::Encode(node, message);
    NextCycle([&] { watch.Sent(bus, frame, now_ns); });
    return watch.first_violation();
  }
};

TEST_F(Watched, ARobotInMotionBreaksNoRuleAndGetsItsCommands) {
  EXPECT_EQ(watch.counts().violations, 0U) << watch.first_violation();
  EXPECT_FALSE(sensors.any_fault()) << sensors.message;
  EXPECT_GT(watch.counts().moving, 40U);
  for (int j = 0; j < 3; ++j) EXPECT_TRUE(watch.moved_as_commanded(j)) << j;
  EXPECT_FALSE(watch.moved_as_commanded(3));
}

TEST_F(Watched, TorqueForAnIdleJointIsSeen) {
  EXPECT_NE(Breaks(1, 2, can::SetInputTorque{0.001}).find("must not move"), std::string::npos);
}
TEST_F(Watched, NeighboursTorqueOnTheOtherBusIsSeen) {
  // Joint 0's own setpoint, on joint 2's bus.
  const double wire_Nm = 0.05 * (8.27 / 600) / 0.0159155;
  EXPECT_NE(Breaks(1, 1, can::SetInputTorque{wire_Nm}), "");
  EXPECT_GT(watch.counts().violations, 0U);
}
TEST_F(Watched, TorqueAboveTheCommandIsSeen) {
  EXPECT_NE(Breaks(0, 1, can::SetInputTorque{0.1}).find("another torque"), std::string::npos);
}
TEST_F(Watched, TorqueThatIsNotFiniteIsSeen) {
  EXPECT_NE(Breaks(0, 1, can::SetInputTorque{std::nan("")}), "");
}
TEST_F(Watched, PositionThatJumpsIsSeen) {
  EXPECT_NE(Breaks(0, 2, can::SetInputPos{5.0, 0.0, 0.0}).find("too far"), std::string::npos);
}
TEST_F(Watched, VelocityAboveTheCommandIsSeen) {
  EXPECT_NE(Breaks(1, 1, can::SetInputVel{9.0, 0.0}).find("another velocity"), std::string::npos);
}
TEST_F(Watched, ArmingAnIdleJointIsSeen) {
  EXPECT_NE(Breaks(1, 2, can::SetAxisState{can::AxisState::kClosedLoopControl}), "");
}
TEST_F(Watched, FrameToAStrangerIsSeen) {
  EXPECT_NE(Breaks(0, 40, can::SetInputTorque{0.0}).find("not ours"), std::string::npos);
}
TEST_F(Watched, ReconfiguringAControllerIsSeen) {
  EXPECT_NE(Breaks(0, 1, can::SetAxisNodeId{3}).find("kind"), std::string::npos);
}
TEST_F(Watched, RelaysOtherThanCommandedAreSeen) {
  EXPECT_NE(Breaks(0, 33, can::ValveCommand{false, true, false, 0, 60}).find("relays"),
            std::string::npos);
}
TEST_F(Watched, CycleWithoutASetpointIsSeen) {
  watch.Begin(plant, command, kPeriod_s);
  watch.End();
  EXPECT_EQ(watch.counts().violations, 4U);
}

// Joints 2 and 3 behind the gateway, 2 in position mode.
class WatchedGateway : public Watched {
 protected:
  WatchedGateway() : Watched(true) {
    command.mode[2] = ControlMode::kPosition;
    command.position_rad[2] = 0.3;
    for (int i = 0; i < 30; ++i) NextCycle();
  }
  // The rule that this cycle's first references break when a field is changed by so many counts.
  std::string Breaks(std::size_t field, int counts) {
    NextCycle([&] {
      for (can::Frame frame : std::vector<can::Frame>(buses[1].sent)) {
        if (frame.id != (48U << 5 | 1U)) continue;
        const int value =
            static_cast<std::int16_t>(frame.data[2 * field] | frame.data[2 * field + 1] << 8) +
            counts;
        frame.data[2 * field] = static_cast<std::uint8_t>(value);
        frame.data[2 * field + 1] = static_cast<std::uint8_t>(value >> 8);
        watch.Sent(1, frame, now_ns);
      }
    });
    return watch.first_violation();
  }
};

TEST_F(WatchedGateway, ARobotInMotionBreaksNoRuleAndGetsItsCommands) {
  EXPECT_EQ(watch.counts().violations, 0U) << watch.first_violation();
  EXPECT_FALSE(sensors.any_fault()) << sensors.message;
  for (int j = 0; j < 3; ++j) EXPECT_TRUE(watch.moved_as_commanded(j)) << j;
  EXPECT_EQ(Breaks(0, 0), "") << "the same once more is none";
}
TEST_F(WatchedGateway, ReferenceThatJumpsIsSeen) {
  EXPECT_NE(Breaks(0, 300).find("too far"), std::string::npos);
}
TEST_F(WatchedGateway, ReferenceThatMovesAnIdleJointIsSeen) {
  EXPECT_NE(Breaks(1, 3).find("must not move"), std::string::npos);
}
TEST_F(WatchedGateway, ReferenceForAnUnusedFieldIsSeen) {
  EXPECT_NE(Breaks(2, 1).find("unused field"), std::string::npos);
}
TEST_F(WatchedGateway, AnswerInTheGatewaysNameIsSeen) {
  watch.Sent(1, can::EncodeState(48, {})[0], now_ns);
  EXPECT_NE(watch.first_violation().find("gateway"), std::string::npos);
}

}  // namespace
}  // namespace sinew::fuzz

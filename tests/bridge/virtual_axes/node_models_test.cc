// Sensor node, gateway and schedule alone: frames in, frames and demands out.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "bridge/joints/compact_link.h"
#include "bridge/virtual_axes/gateway_model.h"
#include "bridge/virtual_axes/schedule.h"
#include "bridge/virtual_axes/sensor_node_model.h"

namespace sinew::virtual_axes {
namespace {

TEST(Schedule, IsDueOnceInEveryPeriod) {
  Schedule schedule(10);
  schedule.Start(0, 3 * kMs_ns);
  int due = 0;
  for (int ms = 0; ms < 100; ++ms) {
    if (!schedule.IsDue(ms * kMs_ns)) continue;
    EXPECT_EQ(ms % 10, 3);
    ++due;
  }
  EXPECT_EQ(due, 10);
}

TEST(Schedule, WhatWasMissedIsLeftOut) {
  Schedule schedule(10);
  schedule.Start(0, 0);
  EXPECT_TRUE(schedule.IsDue(0));
  EXPECT_TRUE(schedule.IsDue(57 * kMs_ns));
  EXPECT_FALSE(schedule.IsDue(66 * kMs_ns));
  EXPECT_TRUE(schedule.IsDue(67 * kMs_ns));
}

TEST(Schedule, ZeroIsNeverAndASpreadIsWithinThePeriod) {
  Schedule never(0);
  never.Start(0, 0);
  EXPECT_FALSE(never.IsDue(1'000'000 * kMs_ns));
  Schedule spread(10);
  spread.Start(0, 25 * kMs_ns);
  EXPECT_FALSE(spread.IsDue(4 * kMs_ns));
  EXPECT_TRUE(spread.IsDue(5 * kMs_ns));
}

class SensorNode : public ::testing::Test {
 protected:
  SensorNode() {
    config.node = 35;
    config.direction = -1;
    config.zero_rad = 0.25;
    sensors.position_rad[0] = 0.5;
    sensors.velocity_rad_s[0] = 2.0;
    sensors.valid[0] = true;
    sensors.chamber_pressure_bar[0] = 4.0;
    sensors.load_force_N[0] = 12.0;
  }
  std::vector<can::Frame> Due(SensorNodeModel& node, std::int64_t now_ns) {
    const auto due = node.Due(sensors, command, now_ns);
    return {due.begin(), due.end()};
  }

  SensorNodeConfig config;
  provider::PlantSensors sensors;
  provider::PlantCommand command;
};

TEST_F(SensorNode, SendsWhatThePlantMeasuresInItsOwnDirectionAndZero) {
  SensorNodeModel node(config);
  node.Start(0, 0);
  const auto frames = Due(node, 0);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(can::DecodeNodeHeartbeat(frames[0])->uptime_ms, 0U);
  const auto output = can::DecodeOutputEncoder(frames[1]);
  EXPECT_NEAR(output->angle_rad, -0.25, 1e-9);
  EXPECT_NEAR(output->velocity_rad_s, -2.0, 1e-9);
  EXPECT_TRUE(output->encoder_valid);
  EXPECT_FALSE(output->watchdog_expired);
  const auto joint = can::DecodeJointSensors(frames[2]);
  EXPECT_NEAR(joint->chamber_pressure_bar, 4.0, 1e-9);
  EXPECT_NEAR(joint->load_force_N, 12.0, 1e-9);
  const auto next = Due(node, 4 * kMs_ns);
  ASSERT_EQ(next.size(), 2U);
  EXPECT_EQ(can::DecodeOutputEncoder(next[0])->sequence, output->sequence + 1);
  EXPECT_EQ(can::DecodeNodeHeartbeat(Due(node, 100 * kMs_ns).at(0))->uptime_ms, 100U);
}

TEST_F(SensorNode, RelaysFollowTheirCommandUntilTheTimeOutOfTheLastOne) {
  SensorNodeModel node(config);
  node.Start(0, 0);
  node.Take(can::Encode(35, can::ValveCommand{true, true, true, 0, 60}), 10 * kMs_ns);
  node.CheckWatchdog(70 * kMs_ns);
  node.Drive(&command);
  EXPECT_TRUE(command.valve_open[0] && command.compressor_on[0] && command.vent_open[0]);
  EXPECT_TRUE(node.valve_open());
  node.CheckWatchdog(70 * kMs_ns + 1);
  node.Drive(&command);
  EXPECT_FALSE(command.valve_open[0] || command.compressor_on[0] || command.vent_open[0]);
  EXPECT_TRUE(can::DecodeOutputEncoder(Due(node, 80 * kMs_ns).at(1))->watchdog_expired);
  node.Take(can::Encode(35, can::ValveCommand{false, false, true, 1, 60}), 90 * kMs_ns);
  EXPECT_FALSE(can::DecodeOutputEncoder(Due(node, 90 * kMs_ns).at(0))->watchdog_expired);
}

TEST_F(SensorNode, ATimeOutOfZeroIsNone) {
  SensorNodeModel node(config);
  node.Start(0, 0);
  node.Take(can::Encode(35, can::ValveCommand{true, false, false, 0, 0}), 0);
  node.CheckWatchdog(1'000'000 * kMs_ns);
  EXPECT_TRUE(node.valve_open());
}

TEST_F(SensorNode, OtherFramesChangeNothing) {
  SensorNodeModel node(config);
  node.Start(0, 0);
  can::Frame cut = can::Encode(35, can::ValveCommand{true, true, true, 0, 60});
  cut.length = 3;
  node.Take(cut, 0);
  EXPECT_FALSE(node.valve_open());
}

class Gateway : public ::testing::Test {
 protected:
  Gateway() {
    for (int node = 1; node <= 6; ++node) {
      AxisConfig axis;
      axis.node = node;
      axis.joint = node - 1;
      axes.emplace_back(axis);
      axes.back().Start(0, 0);
      sensors.motor_position_rad[static_cast<std::size_t>(node - 1)] = node;
    }
  }
  can::CompactState State(const provider::BodySensors* body = nullptr, std::int64_t now_ns = 0) {
    can::CompactState state;
    for (const can::Frame& frame : gateway.State(axes, sensors, body, now_ns)) {
      EXPECT_TRUE(can::DecodeState(48, frame, &state));
    }
    return state;
  }
  double Position(std::size_t axis) {
    provider::PlantCommand command;
    axes[axis].Drive({}, &command);
    return command.position_rad[axis];
  }

  std::vector<AxisModel> axes;
  GatewayModel gateway{{0, 48, {6, 5, 4, 3, 2, 1}}, {5, 4, 3, 2, 1, 0}};
  provider::PlantSensors sensors;
};

TEST_F(Gateway, ReferencesReachTheAxesOfTheirFieldsAndTheLastFrameIsAnswered) {
  for (AxisModel& axis : axes) {
    (void)axis.Take(can::Encode(axis.node(), can::SetAxisState{can::AxisState::kClosedLoopControl}),
                    {}, 0);
  }
  can::CompactReferences references;
  for (std::size_t i = 0; i < 12; ++i) references.position_turns[i] = 0.5 * double(i + 1);
  const auto frames = can::EncodeReferences(48, references);
  EXPECT_FALSE(gateway.Take(frames[0], axes, 0));
  EXPECT_NEAR(Position(5), 0.5 * 2.0 * std::acos(-1.0), 1e-9) << "the first field";
  EXPECT_EQ(Position(0), 0.0) << "in the next frame";
  EXPECT_FALSE(gateway.Take(frames[1], axes, 0));
  EXPECT_NEAR(Position(0), 3.0 * 2.0 * std::acos(-1.0), 1e-9);
  EXPECT_TRUE(gateway.Take(frames[2], axes, 0));
  can::Frame other = frames[2];
  other.id = can::EncodeReferences(47, references)[2].id;
  EXPECT_FALSE(gateway.Take(other, axes, 0));
}

TEST_F(Gateway, AStateHasTheAxesInTheOrderOfTheFieldsAndASilentOneStandsStill) {
  EXPECT_NEAR(State().position_turns[0], 6.0 / (2.0 * std::acos(-1.0)), 0.0051);
  axes[5].Silence(true);
  sensors.motor_position_rad[5] = 60.0;
  sensors.motor_position_rad[4] = 50.0;
  const can::CompactState state = State();
  EXPECT_NEAR(state.position_turns[0], 6.0 / (2.0 * std::acos(-1.0)), 0.0051);
  EXPECT_NEAR(state.position_turns[1], 50.0 / (2.0 * std::acos(-1.0)), 0.0051);
  EXPECT_EQ(state.sequence, 2);
}

TEST_F(Gateway, ForcesAndImuAreThePlants) {
  provider::BodySensors body;
  body.foot_force_N[3] = 12.5;
  body.acceleration_m_s2 = {0.5, -1.25, 9.81};
  body.orientation_wxyz = {std::cos(0.2), std::sin(0.2), 0.0, 0.0};  // 0.4 rad of roll
  const can::CompactState state = State(&body);
  EXPECT_NEAR(state.force_N[3], 12.5, 0.051);
  EXPECT_NEAR(state.acceleration_m_s2[2], 9.81, 0.0051);
  EXPECT_NEAR(state.roll_pitch_yaw_rad[0], 0.4, 1e-4);
  EXPECT_NEAR(state.roll_pitch_yaw_rad[1], 0.0, 1e-4);
}

// The bridge's way back is the inverse.
TEST(RollPitchYaw, IsTheInverseOfTheBridgesQuaternion) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> angle(-1.5, 1.5);
  for (int i = 0; i < 200; ++i) {
    const std::array<double, 3> angles = {angle(random), angle(random), angle(random)};
    const auto back = RollPitchYaw(bridge::QuaternionOf(angles));
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(back[k], angles[k], 1e-9);
  }
  // Straight up: rounding must not leave the range of asin.
  EXPECT_NEAR(RollPitchYaw({std::sqrt(0.5) * (1.0 + 1e-15), 0.0, std::sqrt(0.5), 0.0})[1],
              std::asin(1.0), 1e-7);
}

}  // namespace
}  // namespace sinew::virtual_axes

// Our own frames: sensor node and compact exchange. Expected bytes are written by hand from
// sinew_nodes.dbc; independent_reader_test.cc lets python3-canmatrix read the same file and decode
// what we encode.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "bridge/can/bit_timing.h"
#include "bridge/can/codec.h"
#include "bridge/can/compact.h"
#include "bridge/can/sensor_node.h"

namespace sinew::can {
namespace {

using Bytes = decltype(Frame::data);

TEST(SensorNode, OutputEncoderHasExactlyTheseBytes) {
  OutputEncoder m{0.5, -1.5, 200, true, true, false, true, false, true, true};
  const Frame frame = Encode(32, m);
  EXPECT_EQ(frame.id, 32U * 32 + 0x09);
  EXPECT_EQ(frame.length, 8);
  // 500000 = 0x0007A120; -1500 = 0xFA24; bits 0, 1, 3, 5, 6 = 0x6B
  EXPECT_EQ(frame.data, (Bytes{0x20, 0xA1, 0x07, 0x00, 0x24, 0xFA, 0xC8, 0x6B}));
  EXPECT_EQ(DecodeOutputEncoder(frame), m);
}

TEST(SensorNode, JointSensorsHaveExactlyTheseBytes) {
  JointSensors m{4.123, 6.0, -12.34, 36.5};
  const Frame frame = Encode(33, m);
  EXPECT_EQ(frame.id, 33U * 32 + 0x0A);
  // 4123 = 0x101B; 6000 = 0x1770; -1234 = 0xFB2E; 365 = 0x016D
  EXPECT_EQ(frame.data, (Bytes{0x1B, 0x10, 0x70, 0x17, 0x2E, 0xFB, 0x6D, 0x01}));
  const auto back = DecodeJointSensors(frame);
  ASSERT_TRUE(back);
  EXPECT_DOUBLE_EQ(back->chamber_pressure_bar, 4.123);
  EXPECT_DOUBLE_EQ(back->load_force_N, -12.34);
}

TEST(SensorNode, ValveCommandHasExactlyTheseBytes) {
  ValveCommand m{true, false, true, 7, 60};
  const Frame frame = Encode(32, m);
  EXPECT_EQ(frame.id, 32U * 32 + 0x0B);
  EXPECT_EQ(frame.length, 4);
  EXPECT_EQ(frame.data, (Bytes{0x05, 0x07, 0x3C, 0x00}));
  EXPECT_EQ(DecodeValveCommand(frame), m);
}

TEST(SensorNode, HeartbeatHasExactlyTheseBytes) {
  NodeHeartbeat m{0x12345678, node_error::kPressure, 1};
  EXPECT_EQ(Encode(32, m).data, (Bytes{0x78, 0x56, 0x34, 0x12, 0x02, 0x01}));
  EXPECT_EQ(DecodeNodeHeartbeat(Encode(32, m)), m);
}

TEST(SensorNode, EveryTruncatedLengthIsRefused) {
  for (int length = 0; length <= 8; ++length) {
    const auto cut = [length](Frame frame) {
      frame.length = static_cast<std::uint8_t>(length);
      return frame;
    };
    EXPECT_EQ(DecodeOutputEncoder(cut(Encode(1, OutputEncoder{}))).has_value(), length == 8);
    EXPECT_EQ(DecodeJointSensors(cut(Encode(1, JointSensors{}))).has_value(), length == 8);
    EXPECT_EQ(DecodeValveCommand(cut(Encode(1, ValveCommand{}))).has_value(), length >= 4);
    EXPECT_EQ(DecodeNodeHeartbeat(cut(Encode(1, NodeHeartbeat{}))).has_value(), length >= 6);
  }
}

TEST(SensorNode, ValuesAreHeldAtTheEndsOfTheirFieldAndNanIsZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto m = DecodeJointSensors(Encode(1, JointSensors{1e6, -1e6, nan, 1e300}));
  ASSERT_TRUE(m);
  EXPECT_DOUBLE_EQ(m->chamber_pressure_bar, 32.767);
  EXPECT_DOUBLE_EQ(m->reservoir_pressure_bar, -32.768);
  EXPECT_EQ(m->load_force_N, 0.0);
  EXPECT_DOUBLE_EQ(m->motor_temperature_degC, 3276.7);
}

TEST(SensorNode, RandomValuesComeBackWithinHalfAStep) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-1000, 1000), velocity(-30, 30), pressure(-1, 10);
  for (int i = 0; i < 10000; ++i) {
    OutputEncoder m;
    m.angle_rad = angle(random);
    m.velocity_rad_s = velocity(random);
    const auto back = DecodeOutputEncoder(Encode(40, m));
    ASSERT_TRUE(back);
    ASSERT_NEAR(back->angle_rad, m.angle_rad, 0.5e-6 + 1e-12);
    ASSERT_NEAR(back->velocity_rad_s, m.velocity_rad_s, 0.5e-3 + 1e-12);
    const double bar = pressure(random);
    ASSERT_NEAR(DecodeJointSensors(Encode(40, JointSensors{bar, 0, 0, 0}))->chamber_pressure_bar,
                bar, 0.5e-3 + 1e-12);
  }
}

TEST(Compact, StateComesBackWithinHalfAStepWhateverTheOrderOfItsFrames) {
  CompactState state;
  for (int i = 0; i < 12; ++i) {
    const auto k = static_cast<std::size_t>(i);
    state.position_turns[k] = 13.37 * (i - 6);
    state.velocity_turns_s[k] = -2.5 * i;
    state.iq_A[k] = 0.31 * i;
    if (i < 8) state.force_N[k] = 10.1 * i;
  }
  state.acceleration_m_s2 = {0.1, -0.2, 9.81};
  state.angular_velocity_rad_s = {1.001, -2.002, 3.003};
  state.roll_pitch_yaw_rad = {0.1234, -0.2, 3.1};
  state.sequence = 99;
  const auto frames = EncodeState(48, state);
  CompactState back;
  for (auto frame = frames.rbegin(); frame != frames.rend(); ++frame) {
    EXPECT_TRUE(IsValid(*frame));
    ASSERT_TRUE(DecodeState(48, *frame, &back));
    EXPECT_FALSE(DecodeState(47, *frame, &back)) << "another gateway's";
  }
  for (std::size_t k = 0; k < 12; ++k) {
    EXPECT_NEAR(back.position_turns[k], state.position_turns[k], 0.005 + 1e-9);
    EXPECT_NEAR(back.velocity_turns_s[k], state.velocity_turns_s[k], 0.05 + 1e-9);
    EXPECT_NEAR(back.iq_A[k], state.iq_A[k], 0.005 + 1e-9);
    if (k < 8) {
      EXPECT_NEAR(back.force_N[k], state.force_N[k], 0.05 + 1e-9);
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(back.acceleration_m_s2[k], state.acceleration_m_s2[k], 0.005 + 1e-9);
    EXPECT_NEAR(back.angular_velocity_rad_s[k], state.angular_velocity_rad_s[k], 0.0005 + 1e-9);
    EXPECT_NEAR(back.roll_pitch_yaw_rad[k], state.roll_pitch_yaw_rad[k], 0.00005 + 1e-9);
  }
  EXPECT_EQ(back.sequence, 99);
}

TEST(Compact, ReferencesHaveExactlyTheseBytes) {
  CompactReferences references;
  references.position_turns[0] = 1.0;    // 100 = 0x0064
  references.position_turns[3] = -2.56;  // -256 = 0xFF00
  references.position_turns[11] = 400;   // held at 32767
  const auto frames = EncodeReferences(48, references);
  EXPECT_EQ(frames[0].id, 48U * 32 + 1);
  EXPECT_EQ(frames[0].data, (Bytes{0x64, 0x00, 0, 0, 0, 0, 0x00, 0xFF}));
  EXPECT_EQ(frames[2].data, (Bytes{0, 0, 0, 0, 0, 0, 0xFF, 0x7F}));
  CompactReferences back;
  for (const Frame& frame : frames) EXPECT_TRUE(DecodeReferences(48, frame, &back));
  EXPECT_DOUBLE_EQ(back.position_turns[3], -2.56);
  Frame cut = frames[0];
  cut.length = 7;
  EXPECT_FALSE(DecodeReferences(48, cut, &back));
}

TEST(Compact, WholeExchangeOfTwelveJointsFitsFourHundredTimesIntoASecond) {
  int bits = 0;
  for (const Frame& frame : EncodeReferences(48, {})) bits += WorstFrameBits(frame.length);
  for (const Frame& frame : EncodeState(48, {})) bits += WorstFrameBits(frame.length);
  EXPECT_EQ(bits, 16 * 135 + 95);
  EXPECT_GE(1e6 / bits, 400.0) << bits << " bits at worst stuffing, 1 Mbit/s";
}

}  // namespace
}  // namespace sinew::can

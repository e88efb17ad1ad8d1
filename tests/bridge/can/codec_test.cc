// Expected bytes come from ODrive's odrive-cansimple.dbc, written by python3-canmatrix
// (frame.encode), which shares no line with this codec; the two scaled feed-forwards of
// Set_Input_Pos from the DBC's factor by hand.
#include "bridge/can/codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

namespace sinew::can {
namespace {

std::string Hex(const Frame& frame) {
  std::string text;
  char byte[3];
  for (std::size_t i = 0; i < frame.length; ++i) {
    std::snprintf(byte, sizeof byte, "%02x", frame.data[i]);
    text += byte;
  }
  return text;
}

template <class Message>
void ExpectBytes(int node, const Message& message, std::uint32_t id, const std::string& bytes) {
  const Frame frame = Encode(node, message);
  EXPECT_EQ(frame.id, id);
  EXPECT_EQ(Hex(frame), bytes);
  EXPECT_FALSE(frame.extended);
  EXPECT_FALSE(frame.remote);
  EXPECT_TRUE(IsValid(frame));
  const auto back = Decode<Message>(frame);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(Hex(Encode(node, *back)), bytes) << "decoding and encoding again changes the bytes";
}

TEST(Codec, HeartbeatHasTheBytesOfTheDbc) {
  ExpectBytes(3, Heartbeat{0x40800, AxisState::kClosedLoopControl, false, true, true, true}, 0x61,
              "0008040008000181");
}

TEST(Codec, EncoderEstimatesHaveTheBytesOfTheDbc) {
  ExpectBytes(0, EncoderEstimates{1.5, -2.25}, 0x09, "0000c03f000010c0");
}

TEST(Codec, SetpointsHaveTheBytesOfTheDbc) {
  ExpectBytes(3, SetInputPos{-12.75, 1.234, -0.321}, 0x6C, "00004cc1d204bffe");
  ExpectBytes(0, SetInputVel{3.0, -0.05}, 0x0D, "00004040cdcc4cbd");
  ExpectBytes(1, SetInputTorque{0.1}, 0x2E, "cdcccc3d00000000");
}

TEST(Codec, IqAndBusVoltageHaveTheBytesOfTheDbc) {
  ExpectBytes(1, Iq{2.5, 2.4375}, 0x34, "0000204000001c40");
  ExpectBytes(7, BusVoltageCurrent{24.1, -0.3}, 0xF7, "cdccc0419a9999be");
}

TEST(Codec, StatesAndModesHaveTheBytesOfTheDbc) {
  ExpectBytes(0, SetAxisState{AxisState::kClosedLoopControl}, 0x07, "0800000000000000");
  ExpectBytes(0, SetControllerMode{ControlMode::kTorque, InputMode::kPassthrough}, 0x0B,
              "0100000001000000");
  ExpectBytes(0, SetAxisNodeId{41}, 0x06, "2900000000000000");
}

TEST(Codec, LimitsAndGainsHaveTheBytesOfTheDbc) {
  ExpectBytes(0, SetLimits{50.0, 25.0}, 0x0F, "000048420000c841");
  ExpectBytes(0, SetTrajVelLimit{7.5}, 0x11, "0000f04000000000");
  ExpectBytes(0, SetTrajAccelLimits{2.0, 3.0}, 0x12, "0000004000004040");
  ExpectBytes(0, SetTrajInertia{0.001}, 0x13, "6f12833a00000000");
  ExpectBytes(0, SetPosGain{20.0}, 0x1A, "0000a04100000000");
  ExpectBytes(0, SetVelGains{0.16, 0.32}, 0x1B, "0ad7233e0ad7a33e");
  ExpectBytes(0, SetLinearCount{-123456}, 0x19, "c01dfeff00000000");
}

TEST(Codec, AnswersHaveTheBytesOfTheDbc) {
  ExpectBytes(0, MotorError{0x8000001}, 0x03, "0100000800000000");
  ExpectBytes(0, EncoderError{512}, 0x04, "0002000000000000");
  ExpectBytes(0, SensorlessError{2}, 0x05, "0200000000000000");
  ExpectBytes(0, EncoderCount{70000, 8187}, 0x0A, "70110100fb1f0000");
  ExpectBytes(0, SensorlessEstimates{0.25, -100.0}, 0x15, "0000803e0000c8c2");
  ExpectBytes(0, AdcVoltage{1.65}, 0x1C, "3333d33f00000000");
  ExpectBytes(0, ControllerError{128}, 0x1D, "8000000000000000");
}

TEST(Codec, MessagesWithoutSignalsAreEmptyFrames) {
  ExpectBytes(5, Estop{}, 0xA2, "");
  ExpectBytes(5, StartAnticogging{}, 0xB0, "");
  ExpectBytes(5, Reboot{}, 0xB6, "");
  ExpectBytes(5, ClearErrors{}, 0xB8, "");
}

TEST(Codec, VoltageIsAskedForWithADataFrameOfOneByte) { ExpectBytes(2, AdcRequest{3}, 0x5C, "03"); }

TEST(Codec, HighestNodeFitsIntoElevenBits) {
  EXPECT_EQ(Encode(63, Reboot{}).id, 0x7F6U);
  EXPECT_TRUE(IsValid(Encode(63, Reboot{})));
}

TEST(Codec, OldestFirmwareSendsTheStateInThirtyTwoBitsAndNoFlags) {
  const Heartbeat sent{0x1, AxisState::kIdle, true, true, true, true};
  const Frame frame = Encode(0, sent, Firmware::k0_5_1);
  EXPECT_EQ(Hex(frame), "0100000001000000");
  EXPECT_EQ(Decode<Heartbeat>(frame, Firmware::k0_5_1), (Heartbeat{0x1, AxisState::kIdle}));
}

TEST(Codec, MiddleFirmwareHasOnlyTheTrajectoryFlag) {
  const Heartbeat sent{0, AxisState::kIdle, true, true, true, true};
  const Frame frame = Encode(0, sent, Firmware::k0_5_4);
  EXPECT_EQ(Hex(frame), "0000000001000080");
  EXPECT_EQ(Decode<Heartbeat>(frame, Firmware::k0_5_4),
            (Heartbeat{0, AxisState::kIdle, false, false, false, true}));
}

TEST(Codec, OldFirmwareHasNoBusCurrentAndNoCurrentLimit) {
  EXPECT_EQ(Hex(Encode(0, BusVoltageCurrent{24.1, -0.3}, Firmware::k0_5_4)), "cdccc04100000000");
  EXPECT_EQ(Hex(Encode(0, SetLimits{50.0, 25.0}, Firmware::k0_5_1)), "0000484200000000");
  EXPECT_EQ(Hex(Encode(0, SetLimits{50.0, 25.0}, Firmware::k0_5_4)), "000048420000c841");
}

TEST(Codec, MotorErrorHasSixtyFourBitsFromTheNewestFirmwareOn) {
  const MotorError error{0x0000000200000001};
  EXPECT_EQ(Decode<MotorError>(Encode(0, error)), error);
  EXPECT_EQ(Decode<MotorError>(Encode(0, error, Firmware::k0_5_4), Firmware::k0_5_4),
            MotorError{1});
}

TEST(Codec, CommandsThatAFirmwareLacksAreNotDecoded) {
  EXPECT_FALSE(Decode<SetPosGain>(Encode(0, SetPosGain{20}), Firmware::k0_5_1));
  EXPECT_TRUE(Decode<SetPosGain>(Encode(0, SetPosGain{20}), Firmware::k0_5_4));
  EXPECT_FALSE(Decode<ControllerError>(Encode(0, ControllerError{1}), Firmware::k0_5_4));
  EXPECT_FALSE(Knows(Firmware::k0_5_6, static_cast<Command>(0x00)));
  EXPECT_FALSE(Knows(Firmware::k0_5_6, static_cast<Command>(0x08)));
  EXPECT_FALSE(Knows(Firmware::k0_5_6, static_cast<Command>(0x1E)));
}

TEST(Codec, RequestsAreRemoteFramesOrEmptyFromTheNewestFirmwareOn) {
  const Frame request = EncodeRequest(2, Command::kGetIq);
  EXPECT_EQ(request.id, 0x54U);
  EXPECT_TRUE(request.remote);
  EXPECT_TRUE(IsRequest(request, Firmware::k0_5_1));
  EXPECT_FALSE(Decode<Iq>(request)) << "a question is no answer";
  Frame empty;
  empty.id = request.id;
  EXPECT_TRUE(IsRequest(empty, Firmware::k0_5_6));
  EXPECT_FALSE(IsRequest(empty, Firmware::k0_5_4));
  EXPECT_FALSE(IsRequest(Encode(2, Reboot{}))) << "an empty command is no question";
}

TEST(Codec, FeedForwardsAreRoundedAndHeldAtTheEndsOfTheirField) {
  const auto sent = Decode<SetInputPos>(Encode(0, SetInputPos{0.0, 1.00049, 1.0006}));
  ASSERT_TRUE(sent);
  EXPECT_DOUBLE_EQ(sent->velocity_feed_forward_rev_s, 1.000);
  EXPECT_DOUBLE_EQ(sent->torque_feed_forward_Nm, 1.001);
  const auto held = Decode<SetInputPos>(Encode(0, SetInputPos{0.0, 1e9, -1e9}));
  ASSERT_TRUE(held);
  EXPECT_DOUBLE_EQ(held->velocity_feed_forward_rev_s, 32.767);
  EXPECT_DOUBLE_EQ(held->torque_feed_forward_Nm, -32.768);
}

TEST(Codec, NonFiniteFloatsPassAsTheyAreAndNonFiniteStepsBecomeZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto torque = Decode<SetInputTorque>(Encode(0, SetInputTorque{nan}));
  ASSERT_TRUE(torque);
  EXPECT_TRUE(std::isnan(torque->torque_Nm));
  const auto pos = Decode<SetInputPos>(
      Encode(0, SetInputPos{0.0, nan, -std::numeric_limits<double>::infinity()}));
  ASSERT_TRUE(pos);
  EXPECT_EQ(pos->velocity_feed_forward_rev_s, 0.0);
  EXPECT_DOUBLE_EQ(pos->torque_feed_forward_Nm, -32.768);
}

TEST(Codec, StateBeyondAByteIsUndefined) {
  Frame frame = Encode(0, SetAxisState{AxisState::kClosedLoopControl});
  frame.data[1] = 1;
  EXPECT_EQ(Decode<SetAxisState>(frame)->state, AxisState::kUndefined);
}

// Bytes each decoder needs: from the DBC's signals (last bit of the last signal).
template <class Message>
void ExpectEveryShorterFrameRefused(int needed) {
  for (int length = 0; length <= kMaxDataBytes; ++length) {
    Frame frame = Encode(9, Message{});
    frame.length = static_cast<std::uint8_t>(length);
    EXPECT_EQ(Decode<Message>(frame).has_value(), length >= needed)
        << typeid(Message).name() << " " << length;
  }
}

TEST(Codec, EveryTruncatedLengthIsRefused) {
  ExpectEveryShorterFrameRefused<Heartbeat>(8);
  ExpectEveryShorterFrameRefused<MotorError>(8);
  ExpectEveryShorterFrameRefused<EncoderError>(4);
  ExpectEveryShorterFrameRefused<SensorlessError>(4);
  ExpectEveryShorterFrameRefused<ControllerError>(4);
  ExpectEveryShorterFrameRefused<SetAxisNodeId>(4);
  ExpectEveryShorterFrameRefused<SetAxisState>(4);
  ExpectEveryShorterFrameRefused<EncoderEstimates>(8);
  ExpectEveryShorterFrameRefused<EncoderCount>(8);
  ExpectEveryShorterFrameRefused<SetControllerMode>(8);
  ExpectEveryShorterFrameRefused<SetInputPos>(8);
  ExpectEveryShorterFrameRefused<SetInputVel>(8);
  ExpectEveryShorterFrameRefused<SetInputTorque>(4);
  ExpectEveryShorterFrameRefused<SetLimits>(8);
  ExpectEveryShorterFrameRefused<SetTrajVelLimit>(4);
  ExpectEveryShorterFrameRefused<SetTrajAccelLimits>(8);
  ExpectEveryShorterFrameRefused<SetTrajInertia>(4);
  ExpectEveryShorterFrameRefused<Iq>(8);
  ExpectEveryShorterFrameRefused<SensorlessEstimates>(8);
  ExpectEveryShorterFrameRefused<BusVoltageCurrent>(8);
  ExpectEveryShorterFrameRefused<SetLinearCount>(4);
  ExpectEveryShorterFrameRefused<SetPosGain>(4);
  ExpectEveryShorterFrameRefused<SetVelGains>(8);
  ExpectEveryShorterFrameRefused<AdcVoltage>(4);
  ExpectEveryShorterFrameRefused<AdcRequest>(1);
}

TEST(Codec, RemoteExtendedErrorAndForeignFramesAreRefused) {
  const Frame good = Encode(1, EncoderEstimates{1.0, 2.0});
  ASSERT_TRUE(Decode<EncoderEstimates>(good));
  Frame bad = good;
  bad.remote = true;
  EXPECT_FALSE(Decode<EncoderEstimates>(bad));
  bad = good;
  bad.extended = true;
  EXPECT_FALSE(Decode<EncoderEstimates>(bad));
  bad = good;
  bad.error = true;
  EXPECT_FALSE(Decode<EncoderEstimates>(bad));
  bad = good;
  bad.length = 9;
  EXPECT_FALSE(Decode<EncoderEstimates>(bad));
  EXPECT_FALSE(Decode<Iq>(good));
}

TEST(Codec, TrimmedSetpointsDecodeToTheSameValue) {
  const Frame trimmed = Trim(Encode(1, SetInputTorque{0.1}));
  EXPECT_EQ(Hex(trimmed), "cdcccc3d");
  EXPECT_EQ(Decode<SetInputTorque>(trimmed),
            Decode<SetInputTorque>(Encode(1, SetInputTorque{0.1})));
  EXPECT_EQ(Trim(Encode(1, SetInputPos{1, 2, 3})), Encode(1, SetInputPos{1, 2, 3}));
  EXPECT_EQ(Trim(EncodeRequest(1, Command::kGetIq)), EncodeRequest(1, Command::kGetIq));
}

TEST(Codec, RandomBytesDecodeToWhatTheyEncodeOrToNothing) {
  std::mt19937 random(20240611);
  int decoded = 0;
  for (int i = 0; i < 2'000'000; ++i) {
    Frame frame;
    frame.id = random() & 0x1FFFFFFF;
    if ((i & 3) != 0) frame.id &= kMaxStandardId;
    frame.extended = frame.id > kMaxStandardId;
    frame.remote = (random() & 15) == 0;
    frame.length = static_cast<std::uint8_t>(random() % 12);
    for (std::size_t k = 0; k < kMaxDataBytes; ++k) {
      frame.data[k] = static_cast<std::uint8_t>(random());
    }
    const auto firmware = static_cast<Firmware>(random() % 3);
    if (const auto m = Decode<EncoderEstimates>(frame, firmware)) {
      const Frame again = Encode(AddressOf(frame)->node, *m, firmware);
      ASSERT_EQ(again.id, frame.id);
      // NaN payloads may be quieted by the conversion to double; numbers must survive to the bit.
      if (!std::isnan(m->position_rev) && !std::isnan(m->velocity_rev_s)) {
        ASSERT_EQ(again.data, frame.data);
      }
      ++decoded;
    }
    if (const auto m = Decode<EncoderCount>(frame, firmware)) {
      ASSERT_EQ(Encode(AddressOf(frame)->node, *m, firmware).data, frame.data);
      ++decoded;
    }
    if (const auto m = Decode<Heartbeat>(frame, firmware)) {
      ASSERT_EQ(Decode<Heartbeat>(Encode(AddressOf(frame)->node, *m, firmware), firmware), *m);
      ++decoded;
    }
    (void)Decode<SetInputPos>(frame, firmware);
    (void)Decode<SetControllerMode>(frame, firmware);
    (void)Decode<SetAxisState>(frame, firmware);
    (void)Decode<MotorError>(frame, firmware);
    (void)Trim(frame);
    (void)IsRequest(frame, firmware);
  }
  EXPECT_GT(decoded, 1000);
}

}  // namespace
}  // namespace sinew::can

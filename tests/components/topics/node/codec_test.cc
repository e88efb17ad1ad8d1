#include "components/topics/node/codec.h"

#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/status.h>

#include <algorithm>
#include <cstdlib>
#include <random>

#include "components/topics/node/all_messages.h"  // generated: every message

namespace sinew::node {
namespace {

msg::JointCommand SomeCommand() {
  msg::JointCommand command;
  command.header.session_id = 0x1122334455667788ull;
  command.header.tick = 0x0102030405060708ull;
  command.header.stamp_ns = -5;
  command.header.origin = msg::Origin::kLive;
  command.joint_count = 2;
  command.motor_torque_Nm[1] = -0.25;
  command.mode[1] = msg::CommandMode::kTorque;
  return command;
}

TEST(Codec, GivesBackWhatItEncoded) {
  Bytes bytes;
  ASSERT_TRUE(Encode(SomeCommand(), &bytes));
  msg::JointCommand back;
  ASSERT_TRUE(Decode(bytes, &back));
  EXPECT_EQ(back, SomeCommand());
}

TEST(Codec, BeginsWithTheEncapsulationAndTheHeader) {
  Bytes bytes;
  ASSERT_TRUE(Encode(SomeCommand(), &bytes));
  const std::vector<unsigned> expected = {
      0x00, 0x01, 0x00, 0x00,                          // CDR_LE
      0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11,  // session
      0x08, 0x07, 0x06, 0x05, 0x04, 0x03, 0x02, 0x01,  // tick
      0xFB, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,  // stamp -5
      0x00, 0x00, 0x00, 0x00};                         // origin
  ASSERT_GE(bytes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(std::to_integer<unsigned>(bytes[i]), expected[i]) << "byte " << i;
  }
}

TEST(Codec, PeeksSessionAndTickAndChangesTheOrigin) {
  Bytes bytes;
  ASSERT_TRUE(Encode(SomeCommand(), &bytes));
  HeadOfMessage head;
  ASSERT_TRUE(PeekHead(bytes.data(), bytes.size(), &head));
  EXPECT_EQ(head.session_id, 0x1122334455667788ull);
  EXPECT_EQ(head.tick, 0x0102030405060708ull);
  ASSERT_TRUE(
      PokeOrigin(bytes.data(), bytes.size(), static_cast<std::uint32_t>(msg::Origin::kReplay)));
  msg::JointCommand back, expected = SomeCommand();
  ASSERT_TRUE(Decode(bytes, &back));
  expected.header.origin = msg::Origin::kReplay;
  EXPECT_EQ(back, expected);
}

TEST(Codec, RefusesEveryTruncatedLength) {
  Bytes bytes;
  ASSERT_TRUE(Encode(SomeCommand(), &bytes));
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    msg::JointCommand back;
    EXPECT_FALSE(Decode(Bytes(bytes.begin(), bytes.begin() + static_cast<long>(length)), &back))
        << length;
    HeadOfMessage head;
    EXPECT_EQ(PeekHead(bytes.data(), length, &head), length >= 32) << length;
  }
}

TEST(Codec, SurvivesRandomBytes) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes(random() % 400);
    std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::byte>(random()); });
    msg::ReservoirState state;
    msg::ComponentStatus status;
    (void)Decode(bytes, &state);
    (void)Decode(bytes, &status);
  }
}

TEST(Codec, HashesTheKeyOfComponentStatusOnly) {
  msg::ComponentStatus a, b;
  a.name = "control";
  b.name = "control";
  b.cycles = 7;
  Bytes bytes_a, bytes_b, bytes_c;
  ASSERT_TRUE(Encode(a, &bytes_a) && Encode(b, &bytes_b));
  a.name = "control_2";
  ASSERT_TRUE(Encode(a, &bytes_c));
  std::uint8_t hash_a[16], hash_b[16], hash_c[16];
  ASSERT_TRUE(KeyHash("sinew::msg::ComponentStatus", bytes_a, hash_a));
  ASSERT_TRUE(KeyHash("sinew::msg::ComponentStatus", bytes_b, hash_b));
  ASSERT_TRUE(KeyHash("sinew::msg::ComponentStatus", bytes_c, hash_c));
  EXPECT_TRUE(std::equal(hash_a, hash_a + 16, hash_b));
  EXPECT_FALSE(std::equal(hash_a, hash_a + 16, hash_c));
  EXPECT_FALSE(KeyHash("sinew::msg::JointCommand", bytes_a, hash_a));
}

TEST(Codec, RefusesEnumeratorsWithoutANameAndCountsBeyondTheirArrays) {
  const auto survives = [](const auto& change) {
    msg::JointCommand command = SomeCommand();
    change(command);
    Bytes bytes;
    EXPECT_TRUE(Encode(command, &bytes));
    msg::JointCommand back;
    return Decode(bytes, &back);
  };
  EXPECT_TRUE(survives([](msg::JointCommand& c) { c.joint_count = 12; }));
  EXPECT_FALSE(survives([](msg::JointCommand& c) { c.joint_count = 13; }));
  EXPECT_FALSE(survives([](msg::JointCommand& c) { c.joint_count = 255; }));
  EXPECT_TRUE(survives([](msg::JointCommand& c) { c.mode[11] = msg::CommandMode::kVelocity; }));
  EXPECT_FALSE(survives([](msg::JointCommand& c) { c.mode[11] = msg::CommandMode(4); }));
  EXPECT_FALSE(survives([](msg::JointCommand& c) { c.header.origin = msg::Origin(3); }));
  EXPECT_FALSE(survives([](msg::JointCommand& c) { c.header.origin = msg::Origin(0x80000000u); }));
}

TEST(Codec, WhatAMutatedPayloadDecodesToHasAMeaning) {
  Bytes whole;
  ASSERT_TRUE(Encode(SomeCommand(), &whole));
  std::mt19937 random(5);
  msg::JointCommand back;
  int accepted = 0, refused = 0;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = whole;
    const int changes = 1 + static_cast<int>(random() % 8);
    for (int k = 0; k < changes; ++k) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
    if (random() % 8 == 0) bytes.resize(random() % (bytes.size() + 1));
    if (!Decode(bytes, &back)) {
      ++refused;
      continue;
    }
    ++accepted;
    ASSERT_LE(back.joint_count, 12);
    ASSERT_LE(back.header.origin, msg::Origin::kReplay);
    for (const msg::CommandMode mode : back.mode) ASSERT_LE(mode, msg::CommandMode::kVelocity);
  }
  EXPECT_GT(accepted, 1000);
  EXPECT_GT(refused, 1000);
}

// Decodes damaged copies of one message, and what came out again: under the sanitizers nothing may
// be read or written that is not there. SINEW_PAYLOADS: how many of each message.
template <class Message>
void DamagePayloadsOf(const char* name) {
  const char* wanted = std::getenv("SINEW_PAYLOADS");
  const long count = wanted != nullptr ? std::atol(wanted) : 2000;
  ASSERT_GT(count, 0) << "SINEW_PAYLOADS";
  Bytes whole;
  ASSERT_TRUE(Encode(Message(), &whole)) << name;
  std::mt19937 random(static_cast<unsigned>(whole.size()));
  Message message;
  Bytes again;
  for (long round = 0; round < count; ++round) {
    Bytes bytes = whole;
    for (unsigned changes = 1 + random() % 8; changes > 0; --changes) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random());
    }
    if (random() % 8 == 0) bytes.resize(random() % (2 * bytes.size()));
    if (!Decode(bytes, &message)) continue;
    ASSERT_TRUE(Encode(message, &again)) << name << ", round " << round;
    ASSERT_TRUE(Decode(again, &message)) << name << ", round " << round;
  }
}

TEST(Codec, DamagedPayloadsOfEveryMessageAreRefusedOrDecodedWhole) {
#define SINEW_DAMAGE(Type) DamagePayloadsOf<msg::Type>(#Type);
  SINEW_FOR_EACH_MESSAGE(SINEW_DAMAGE)
#undef SINEW_DAMAGE
}

}  // namespace
}  // namespace sinew::node

#include "bridge/can/candump.h"

#include <gtest/gtest.h>

#include <random>

#include "bridge/can/codec.h"

namespace sinew::can {
namespace {

// Lines as candump -l of can-utils 2020.11 writes them.
TEST(Candump, LinesOfTheRealProgramAreRead) {
  const auto line = ParseCandump("(1436509052.249713) vcan0 044#2A366C2BBA");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->stamp_ns, 1436509052249713000);
  EXPECT_EQ(line->interface, "vcan0");
  EXPECT_EQ(line->frame.id, 0x44U);
  EXPECT_EQ(line->frame.length, 5);
  EXPECT_EQ(line->frame.data[4], 0xBA);
  EXPECT_FALSE(line->frame.extended);

  const auto extended = ParseCandump("(1436509053.850870) can1 1ABCDEF0#");
  ASSERT_TRUE(extended);
  EXPECT_TRUE(extended->frame.extended);
  EXPECT_EQ(extended->frame.length, 0);

  const auto remote = ParseCandump("(0000000001.000000) can0 123#R8");
  ASSERT_TRUE(remote);
  EXPECT_TRUE(remote->frame.remote);
  EXPECT_EQ(remote->frame.length, 8);

  const auto error = ParseCandump("(0000000001.000000) can0 20000040#0000000000000000");
  ASSERT_TRUE(error);
  EXPECT_TRUE(error->frame.error);
  EXPECT_EQ(error->frame.id, 0x40U);

  EXPECT_TRUE(ParseCandump("(0000000001.000000) can0 123#00 R\r"));
}

TEST(Candump, FdFramesHaveASecondHashAndFlags) {
  const auto line = ParseCandump("(1436509052.249713) vcan0 123##1000102030405060708090A0B");
  ASSERT_TRUE(line);
  EXPECT_TRUE(line->frame.fd);
  EXPECT_TRUE(line->frame.bit_rate_switch);
  EXPECT_EQ(line->frame.length, 12);
  EXPECT_EQ(line->frame.data[11], 0x0B);
  EXPECT_EQ(FormatCandump(*line), "(1436509052.249713) vcan0 123##1000102030405060708090A0B");
  EXPECT_TRUE(ParseCandump("(1436509052.249713) vcan0 123##0"));
  EXPECT_FALSE(ParseCandump("(1436509052.249713) vcan0 123##")) << "flags are missing";
  EXPECT_FALSE(ParseCandump("(1436509052.249713) vcan0 123##0010203040506070809"))
      << "no frame has nine bytes";
}

// candump -8: eight bytes whose length field said 9 to 15.
TEST(Candump, ARawDlcIsRead) {
  const auto line = ParseCandump("(1436509052.249713) can0 123#1122334455667788_9");
  ASSERT_TRUE(line);
  EXPECT_EQ(line->frame.length, 8);
  EXPECT_EQ(line->frame.data[7], 0x88);
  const auto remote = ParseCandump("(1436509052.249713) can0 12345678#R8_F T");
  ASSERT_TRUE(remote);
  EXPECT_TRUE(remote->frame.remote && remote->frame.extended);
  EXPECT_EQ(remote->frame.length, 8);
  for (const char* wrong :
       {"123#1122334455667788_8", "123#1122334455667788_", "123#1122334455667788_9A", "123#11_9",
        "123#R7_9", "123#R8_", "123##01122334455667788_9", "123#112233445566778899"}) {
    EXPECT_FALSE(ParseCandump(std::string("(1436509052.249713) can0 ") + wrong)) << wrong;
  }
}

TEST(Candump, FramesOfCanXlAreKnown) {
  const char* line = "(1436509052.249713) can0 45123#81:00:12345678#11223344.55667788";
  EXPECT_FALSE(ParseCandump(line));
  EXPECT_TRUE(IsCanXl(line));
  EXPECT_FALSE(IsCanXl("(1436509052.249713) can0 123#1122334455667788"));
  EXPECT_FALSE(IsCanXl("a log of ours: nothing"));
}

TEST(Candump, ExactTextIsWritten) {
  EXPECT_EQ(FormatCandump({1436509052249713999, "vcan0", Encode(1, SetInputTorque{0.1})}),
            "(1436509052.249713) vcan0 02E#CDCCCC3D00000000");
  EXPECT_EQ(FormatCandump({0, "can0", EncodeRequest(1, Command::kGetIq)}),
            "(0000000000.000000) can0 034#R8");
}

TEST(Candump, WhatIsWrittenIsReadBackTheSame) {
  std::mt19937 random(5);
  for (int i = 0; i < 10000; ++i) {
    LogLine line;
    line.stamp_ns = static_cast<std::int64_t>(random()) * 1'000'000;
    line.interface = "can" + std::to_string(random() % 3);
    Frame& frame = line.frame;
    frame.extended = random() % 2 == 0;
    frame.id = random() & (frame.extended ? kMaxExtendedId : kMaxStandardId);
    frame.remote = random() % 5 == 0;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    if (!frame.remote) {
      for (std::size_t k = 0; k < frame.length; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random());
    }
    ASSERT_EQ(ParseCandump(FormatCandump(line)), line) << FormatCandump(line);
  }
}

TEST(Candump, BrokenLinesAreRefused) {
  for (const char* text :
       {"", "(", "()", "123#00", "(1.0) can0 123#00", "(1.000000) can0 123",
        "(1.000000) can0 12#00", "(1.000000) can0 123#0", "(1.000000) can0 123#0G",
        "(1.000000) can0 123#001122334455667788", "(1.000000) can0 FFF#00",
        "(1.000000) can0 123#R9", "(1.000000) can0 123##G00", "(1.000000)can0 123#00",
        "(-1.000000) can0 123#00", "(1.000000) can0 ZZZ#00", "(1.000000)  123#00",
        "(99999999999999999999.000000) can0 123#00"}) {
    EXPECT_FALSE(ParseCandump(text)) << text;
  }
}

TEST(Candump, EveryTruncationOfALineIsRefusedOrAShorterFrame) {
  const std::string whole = "(1436509052.249713) vcan0 044#2A366C2BBA";
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const auto line = ParseCandump(whole.substr(0, n));
    if (line) {
      EXPECT_LT(line->frame.length, 5);
    }
  }
}

TEST(Candump, RandomTextIsRefusedWithoutHarm) {
  std::mt19937 random(9);
  const std::string alphabet = "()0123456789.ABCDEFR# can";
  for (int i = 0; i < 200000; ++i) {
    std::string text;
    for (unsigned n = random() % 50; n > 0; --n) text += alphabet[random() % alphabet.size()];
    if (const auto line = ParseCandump(text)) {
      EXPECT_TRUE(IsValid(line->frame));
    }
  }
}

}  // namespace
}  // namespace sinew::can

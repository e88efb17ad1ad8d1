// Oracles: ISO 11898-1 by a slow bit-string implementation of its own, the published worst cases
// (135 bits for eight bytes, 95 for four), and laws: nothing lost, nothing overlapping, order by
// identifier.
#include "bridge/can/bus_model.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <string>

#include "bridge/can/bit_timing.h"
#include "bridge/can/codec.h"

namespace sinew::can {
namespace {

Frame Data(std::uint32_t id, std::initializer_list<int> bytes) {
  Frame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

std::string Bits(std::uint32_t value, int count) {
  std::string text;
  for (int i = count - 1; i >= 0; --i) text += (value >> i & 1) != 0 ? '1' : '0';
  return text;
}

// Long division by the generator, on text.
std::string Remainder(std::string bits) {
  const std::string generator = "1100010110011001";  // x^15 + ... = 0x4599 with its leading one
  bits += std::string(15, '0');
  for (std::size_t i = 0; i + 15 < bits.size(); ++i) {
    if (bits[i] == '0') continue;
    for (std::size_t k = 0; k < generator.size(); ++k) {
      bits[i + k] = bits[i + k] == generator[k] ? '0' : '1';
    }
  }
  return bits.substr(bits.size() - 15);
}

std::string Stuff(const std::string& bits) {
  std::string out;
  for (const char bit : bits) {
    out += bit;
    const std::size_t n = out.size();
    if (n >= 5 && out.find_first_not_of(bit, n - 5) == std::string::npos) {
      // Five in a row since the last change. A stuff bit counts into the next run by itself.
      out += bit == '0' ? '1' : '0';
    }
  }
  return out;
}

std::string SlowHeader(const Frame& frame) {
  std::string bits = "0";
  if (frame.extended) {
    bits += Bits(frame.id >> 18, 11) + "11" + Bits(frame.id & 0x3FFFF, 18) +
            (frame.remote ? "1" : "0") + "00";
  } else {
    bits += Bits(frame.id, 11) + (frame.remote ? "1" : "0") + "00";
  }
  bits += Bits(frame.length, 4);
  if (!frame.remote) {
    for (std::size_t i = 0; i < frame.length; ++i) bits += Bits(frame.data[i], 8);
  }
  return bits;
}

// Fields of ISO 11898-1:2015, counted by hand: no five equal bits in front of the CRC field.
TEST(BitTiming, FdFramesTakeTheirFixedStuffBits) {
  Frame frame;
  frame.id = 0x555;
  frame.fd = frame.bit_rate_switch = true;
  frame.length = 8;
  std::fill_n(frame.data.begin(), 8, 0x55);
  ASSERT_TRUE(IsValid(frame));
  EXPECT_EQ(FrameBits(frame), 22 + 64 + (4 + 17 + 6) + 13);
  frame.length = 64;
  frame.data.fill(0x55);
  EXPECT_EQ(FrameBits(frame), 22 + 512 + (4 + 21 + 7) + 13);
  // Four zero bytes behind the three of the length: a stuff bit after each five, but none at the
  // end.
  frame.data.fill(0);
  frame.length = 4;
  EXPECT_EQ(FrameBits(frame), 22 + 32 + 6 + (4 + 17 + 6) + 13);
}

TEST(BusModel, AClassicBusRefusesFdFrames) {
  BusModel bus({});
  const int node = bus.Attach();
  Frame frame = Data(1, {1, 2, 3});
  EXPECT_TRUE(bus.Offer(node, frame, 0));
  frame.fd = true;
  EXPECT_FALSE(bus.Offer(node, frame, 0));
  EXPECT_EQ(bus.counters().refused, 1U);
}

TEST(BitTiming, FrameBitsAgreeWithASlowImplementationOnText) {
  std::mt19937 random(3);
  for (int i = 0; i < 20000; ++i) {
    Frame frame;
    frame.extended = random() % 3 == 0;
    frame.id = random() & (frame.extended ? kMaxExtendedId : kMaxStandardId);
    frame.remote = random() % 8 == 0;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    // Many equal bits, so that stuffing has work.
    if (!frame.remote) {
      for (std::size_t k = 0; k < frame.length; ++k) {
        frame.data[k] = random() % 2 == 0 ? static_cast<std::uint8_t>(random())
                                          : (random() % 2 == 0 ? 0x00 : 0xFF);
      }
    }
    const std::string header = SlowHeader(frame);
    const std::string stuffed = Stuff(header + Remainder(header));
    ASSERT_EQ(FrameBits(frame), static_cast<int>(stuffed.size()) + 13);
    ASSERT_LE(FrameBits(frame), WorstFrameBits(frame.length, frame.extended));
  }
}

TEST(BitTiming, WorstCasesAreThePublishedOnes) {
  EXPECT_EQ(WorstFrameBits(8), 135);
  EXPECT_EQ(WorstFrameBits(4), 95);
  EXPECT_EQ(WorstFrameBits(0), 55);
  EXPECT_EQ(WorstFrameBits(8, true), 160);
}

TEST(BitTiming, TwelveAxesWithTorqueAndEstimatesTakeAboutTwoPointEightMilliseconds) {
  EXPECT_EQ(12 * (WorstFrameBits(4) + WorstFrameBits(8)), 2760);
}

TEST(BitTiming, ArbitrationPrefersLowIdentifiersDataAndStandardFrames) {
  Frame data = Data(0x100, {});
  Frame remote = data;
  remote.remote = true;
  Frame extended = data;
  extended.extended = true;
  extended.id = 0x100U << 18;
  EXPECT_LT(ArbitrationKey(Data(0x0FF, {1})), ArbitrationKey(data));
  EXPECT_LT(ArbitrationKey(data), ArbitrationKey(remote));
  EXPECT_LT(ArbitrationKey(remote), ArbitrationKey(extended));
  EXPECT_LT(ArbitrationKey(extended), ArbitrationKey(Data(0x101, {})));
}

TEST(BusModel, BadConfigurationIsRefused) {
  EXPECT_THROW(BusModel({.bitrate_bit_s = 0}), std::invalid_argument);
  EXPECT_THROW(BusModel({.bitrate_bit_s = 2e6}), std::invalid_argument);
  EXPECT_THROW(BusModel({.queue_frames = 0}), std::invalid_argument);
}

TEST(BusModel, IdleBusHasNothingToDo) {
  BusModel bus({});
  bus.Attach();
  EXPECT_FALSE(bus.NextEnd());
  bus.Advance(1'000'000, [](const Delivery&) { FAIL(); });
}

TEST(BusModel, FrameArrivesAfterExactlyItsBitTimes) {
  BusModel bus({.bitrate_bit_s = 500e3});
  const int node = bus.Attach();
  const Frame frame = Data(0x123, {1, 2, 3});
  ASSERT_TRUE(bus.Offer(node, frame, 1000));
  const std::int64_t end = 1000 + 2000 * FrameBits(frame);
  EXPECT_EQ(bus.NextEnd(), end);
  int delivered = 0;
  bus.Advance(end - 1, [&](const Delivery&) { ++delivered; });
  EXPECT_EQ(delivered, 0);
  bus.Advance(end, [&](const Delivery& d) {
    ++delivered;
    EXPECT_EQ(d.frame, frame);
    EXPECT_EQ(d.end_ns, end);
    EXPECT_EQ(d.senders, std::vector<int>{node});
  });
  EXPECT_EQ(delivered, 1);
}

TEST(BusModel, LowestIdentifierWinsAndTheRestFollowWithoutAGap) {
  BusModel bus({});
  const int a = bus.Attach(), b = bus.Attach(), c = bus.Attach();
  bus.Offer(a, Data(0x300, {1}), 0);
  bus.Offer(b, Data(0x100, {2}), 0);
  bus.Offer(c, Data(0x200, {3}), 0);
  std::vector<std::uint32_t> order;
  std::int64_t end = 0;
  std::int64_t bits = 0;
  bus.Advance(10'000'000, [&](const Delivery& d) {
    order.push_back(d.frame.id);
    bits += FrameBits(d.frame);
    end = d.end_ns;
  });
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x100, 0x200, 0x300}));
  EXPECT_EQ(end, 1000 * bits);
}

TEST(BusModel, FrameOnTheBusIsNotInterruptedByAMoreUrgentOne) {
  BusModel bus({});
  const int a = bus.Attach(), b = bus.Attach();
  bus.Offer(a, Data(0x700, {0, 0}), 0);
  bus.Advance(5'000, nullptr);
  bus.Offer(b, Data(0x001, {}), 5'000);
  std::vector<std::uint32_t> order;
  bus.Advance(1'000'000, [&](const Delivery& d) { order.push_back(d.frame.id); });
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x700, 0x001}));
}

TEST(BusModel, OwnQueueIsSentInOrderWhateverTheIdentifiers) {
  BusModel bus({});
  const int a = bus.Attach();
  bus.Offer(a, Data(0x300, {}), 0);
  bus.Offer(a, Data(0x100, {}), 0);
  std::vector<std::uint32_t> order;
  bus.Advance(1'000'000, [&](const Delivery& d) { order.push_back(d.frame.id); });
  EXPECT_EQ(order, (std::vector<std::uint32_t>{0x300, 0x100}));
}

TEST(BusModel, FullQueueRefusesAndCounts) {
  BusModel bus({.queue_frames = 2});
  const int a = bus.Attach();
  EXPECT_TRUE(bus.Offer(a, Data(1, {}), 0));
  EXPECT_TRUE(bus.Offer(a, Data(2, {}), 0));
  EXPECT_FALSE(bus.Offer(a, Data(3, {}), 0));
  EXPECT_EQ(bus.counters().refused, 1U);
}

TEST(BusModel, InvalidFramesAndUnknownNodesAreRefused) {
  BusModel bus({});
  const int a = bus.Attach();
  Frame bad = Data(0x800, {});
  EXPECT_FALSE(bus.Offer(a, bad, 0));
  bad = Data(1, {});
  bad.length = 9;
  EXPECT_FALSE(bus.Offer(a, bad, 0));
  bad = Data(1, {});
  bad.error = true;
  EXPECT_FALSE(bus.Offer(a, bad, 0));
  EXPECT_FALSE(bus.Offer(a + 1, Data(1, {}), 0));
  EXPECT_FALSE(bus.Offer(-1, Data(1, {}), 0));
}

TEST(BusModel, IdenticalFramesAtOnceAreOneFrame) {
  BusModel bus({});
  const int a = bus.Attach(), b = bus.Attach();
  Frame request = EncodeRequest(3, Command::kGetIq);
  bus.Offer(a, request, 0);
  bus.Offer(b, request, 0);
  int delivered = 0;
  bus.Advance(1'000'000, [&](const Delivery& d) {
    ++delivered;
    EXPECT_EQ(d.senders.size(), 2U);
  });
  EXPECT_EQ(delivered, 1);
  EXPECT_EQ(bus.counters().error_frames, 0U);
}

TEST(BusModel, SameIdentifierWithOtherContentEndsInBusOffAndARestart) {
  BusModel bus({.restart_ns = 1'000'000});
  const int a = bus.Attach(), b = bus.Attach();
  bus.Offer(a, Data(0x10, {1}), 0);
  bus.Offer(b, Data(0x10, {2}), 0);
  bus.Advance(500'000, nullptr);
  EXPECT_EQ(bus.health(a), NodeHealth::kActive);
  bus.Advance(3'000'000, nullptr);
  EXPECT_EQ(bus.counters().error_frames, 32U) << "8 each, bus-off above 255";
  EXPECT_EQ(bus.counters().frames, 0U);
  // 32 collisions of 58 bits: bus-off at 1.856 ms, restart at 2.856 ms.
  EXPECT_EQ(bus.health(a), NodeHealth::kActive) << "restarted";
  EXPECT_EQ(bus.queued(a), 0);
  EXPECT_TRUE(bus.Offer(a, Data(0x10, {1}), 3'000'000));
  int delivered = 0;
  bus.Advance(4'000'000, [&](const Delivery&) { ++delivered; });
  EXPECT_EQ(delivered, 1);
}

TEST(BusModel, NodeThatIsBusOffIsRefused) {
  BusModel bus({.restart_ns = -1});
  const int a = bus.Attach(), b = bus.Attach();
  bus.Offer(a, Data(0x10, {1}), 0);
  bus.Offer(b, Data(0x10, {2}), 0);
  bus.Advance(1'000'000'000, nullptr);
  EXPECT_EQ(bus.health(a), NodeHealth::kBusOff);
  EXPECT_FALSE(bus.Offer(a, Data(0x10, {1}), 2'000'000'000));
}

TEST(BusModel, DetachedNodeLeavesNothingBehindAndItsPlaceIsUsedAgain) {
  BusModel bus({});
  const int a = bus.Attach(), b = bus.Attach();
  bus.Offer(a, Data(0x10, {1}), 0);
  bus.Offer(b, Data(0x20, {1}), 0);
  bus.Detach(a);
  std::vector<std::uint32_t> order;
  bus.Advance(1'000'000, [&](const Delivery& d) { order.push_back(d.frame.id); });
  EXPECT_EQ(order, std::vector<std::uint32_t>{0x20});
  EXPECT_EQ(bus.Attach(), a);
}

TEST(BusModel, LongRunLosesNothingAndNeverOverlaps) {
  BusModel bus({.bitrate_bit_s = 1e6, .queue_frames = 64});
  std::mt19937 random(11);
  std::vector<int> nodes;
  for (int i = 0; i < 13; ++i) nodes.push_back(bus.Attach());
  std::uint64_t offered = 0, delivered = 0;
  std::int64_t now = 0, last_end = 0, busy = 0;
  const auto deliver = [&](const Delivery& d) {
    ++delivered;
    const std::int64_t length = 1000 * FrameBits(d.frame);
    ASSERT_GE(d.end_ns - length, last_end) << "two frames on the bus at once";
    last_end = d.end_ns;
    busy += length;
  };
  for (int i = 0; i < 100'000; ++i) {
    now += random() % 400'000;
    bus.Advance(now, deliver);
    const std::size_t who = random() % nodes.size();
    // Identifiers of a node are its own, as the protocol wants it.
    Frame frame = Data(static_cast<std::uint32_t>(who * 32 + random() % 32), {});
    frame.length = static_cast<std::uint8_t>(random() % 9);
    for (std::size_t k = 0; k < frame.length; ++k)
      frame.data[k] = static_cast<std::uint8_t>(random());
    if (bus.Offer(nodes[who], frame, now)) ++offered;
  }
  bus.Advance(now + 1'000'000'000, deliver);
  EXPECT_EQ(delivered, offered);
  EXPECT_EQ(bus.counters().busy_ns, busy);
  EXPECT_EQ(bus.counters().error_frames, 0U);
}

}  // namespace
}  // namespace sinew::can

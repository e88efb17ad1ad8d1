// Which datagrams Fast DDS may read. Each one that has to be dropped ends a process, hangs it or
// reads beyond its bytes without the filter, or would in a version of the library.
#include "components/topics/node/datagram_filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/components/topics/node/datagrams.h"

namespace sinew::node::internal {
namespace {

using namespace sinew::node::testing;

constexpr std::initializer_list<std::uint8_t> kWriter = {0, 0, 1, 3};

Datagram Passed(const Datagram& datagram, bool secure = false) {
  Datagram copy;
  const auto out =
      DatagramFilter(secure ? Protection::kAllowed : Protection::kNone).Pass(datagram, &copy);
  return {out.begin(), out.end()};
}
bool Passes(const Datagram& datagram) { return Passed(datagram) == datagram; }
bool IsDropped(const Datagram& datagram) { return Passed(datagram).empty(); }

Datagram Only(std::uint8_t id, const Datagram& body, std::uint8_t flags = 1) {
  Datagram out = Header();
  AddSubmessage(&out, id, body, flags);
  return out;
}
Datagram Sample() { return Only(kDataId, Data(kWriter, {0, 1, 0, 0, 7, 7, 7, 7}), kWithPayload); }
Datagram Statistics() { return Datagram(56, 9); }
Datagram Announces(std::initializer_list<Datagram> parameters) {
  return Only(kDataId, Announcement(parameters), kWithPayload);
}

Datagram Handshake(std::uint32_t tokens, std::uint32_t properties) {
  Datagram payload = {0, 1, 0, 0};
  payload.resize(payload.size() + 96);
  AddText(&payload, "dds.sec.auth");
  AddNumber(&payload, tokens, 4);
  AddText(&payload, "DDS:Auth:PKI-DH:1.0+Req");
  AddNumber(&payload, properties, 4);
  AddNumber(&payload, 1, 4);
  AddText(&payload, "c.id");
  AddNumber(&payload, 4, 4);
  AddNumber(&payload, 7, 4);
  return Only(kDataId, Data({0, 2, 1, 0xc3}, payload), kWithPayload);
}

TEST(DatagramFilter, WhatParticipantsSendPassesAsItIs) {
  EXPECT_TRUE(Passes(Sample()));
  Datagram name;
  AddText(&name, "sinew-control");
  EXPECT_TRUE(Passes(Announces({Parameter(0x15, {2, 2, 0, 0}), Parameter(0x50, Datagram(16, 1)),
                                Parameter(0x32, Datagram(24, 1)), Parameter(0x62, name)})));
  Datagram heartbeat;
  AddNumber(&heartbeat, 0, 4);
  Add(&heartbeat, kWriter);
  AddSequenceNumber(&heartbeat, 1);
  AddSequenceNumber(&heartbeat, 0);  // nothing yet
  AddNumber(&heartbeat, 3, 4);
  EXPECT_TRUE(Passes(Only(0x07, heartbeat)));
}

TEST(DatagramFilter, NoRtpsIsDropped) {
  EXPECT_TRUE(IsDropped({}));
  EXPECT_TRUE(IsDropped({'R', 'T', 'P', 'S'}));
  EXPECT_TRUE(IsDropped(Header()));
  Datagram other = Sample();
  other[0] = 'X';
  EXPECT_TRUE(IsDropped(other));
  Datagram version = Sample();
  version[4] = 3;
  EXPECT_TRUE(IsDropped(version));
}

// Fast DDS 2.9 clears what has no lease, or a short one, while it still reads it.
TEST(DatagramFilter, AParticipantHasALeaseOfASecondOrMore) {
  const auto announces = [](const Datagram& lease) {
    return Only(kDataId, Announcement({Parameter(0x15, {2, 2, 0, 0})}, lease), kWithPayload);
  };
  EXPECT_TRUE(Passes(announces(Lease(1))));
  EXPECT_TRUE(Passes(announces(Lease(0x7fffffff))));
  EXPECT_TRUE(IsDropped(announces({})));
  EXPECT_TRUE(IsDropped(announces(Lease(0))));
  EXPECT_TRUE(IsDropped(announces(Lease(0xffffffff))));  // -1
  Datagram twice = Lease(1);
  Add(&twice, Lease(0));  // the last one counts
  EXPECT_TRUE(IsDropped(announces(twice)));
  // The end of a participant says its key alone.
  constexpr std::uint8_t kWithKey = 1 | 8;
  EXPECT_TRUE(Passes(
      Only(kDataId, Announcement({Parameter(0x50, Datagram(16, 1))}, Datagram{}), kWithKey)));
}

TEST(DatagramFilter, SubmessagesOfVendorsAreTakenOut) {
  const Datagram sample = Sample();
  Datagram behind = sample;
  AddSubmessage(&behind, kStatisticsId, Statistics());
  EXPECT_EQ(Passed(behind), sample);

  // Fast DDS 2.9 ends the process where anything follows them.
  Datagram hostile = Only(kStatisticsId, Statistics());
  hostile.insert(hostile.end(), {1, 1, 0, 0});
  ASSERT_EQ(Passed(hostile).size(), hostile.size());
  EXPECT_EQ(Passed(hostile)[20], 0x01);  // padding in its place

  Datagram between = Only(0x81, {1, 2, 3, 4});
  Add(&between, std::span(sample).subspan(20));
  const Datagram passed = Passed(between);
  ASSERT_EQ(passed.size(), between.size());
  EXPECT_TRUE(std::equal(sample.begin() + 20, sample.end(), passed.end() - (sample.size() - 20)));
  EXPECT_TRUE(IsDropped(Only(kStatisticsId, Statistics())));  // nothing is left
}

TEST(DatagramFilter, SecureSubmessagesPassWithSecurityOnly) {
  const Datagram secure = Only(0x31, {1, 2, 3, 4});
  EXPECT_TRUE(IsDropped(secure));
  EXPECT_EQ(Passed(secure, true), secure);
}

// Where DDS security protects all: what Fast DDS 2.9 would read although it is not encrypted.
TEST(DatagramFilter, PlainSubmessagesAreTakenOutWhereAllAreProtected) {
  const auto passed = [](const Datagram& datagram) {
    Datagram copy;
    const auto out = DatagramFilter(Protection::kRequired).Pass(datagram, &copy);
    return Datagram(out.begin(), out.end());
  };
  const Datagram stamp = Only(0x09, Datagram(8, 1));
  Datagram stamped = stamp;
  AddSubmessage(&stamped, kDataId, Data(kWriter, {0, 1, 0, 0, 7, 7, 7, 7}), kWithPayload);
  EXPECT_TRUE(Passes(stamped));
  EXPECT_TRUE(passed(stamped).empty());
  Datagram numbers;  // reader, writer, a set or a range
  AddNumber(&numbers, 0, 4);
  Add(&numbers, kWriter);
  for (const std::uint64_t number : {1u, 1u}) AddSequenceNumber(&numbers, number);
  AddNumber(&numbers, 1, 4);
  for (const std::uint8_t id : {0x06, 0x07, 0x08, 0x12, 0x13}) {
    EXPECT_TRUE(passed(Only(id, numbers)).empty()) << int{id};
  }
  EXPECT_TRUE(passed(Only(kFragmentId, numbers)).empty());
  EXPECT_TRUE(passed(Only(kDataId, {1, 2, 3})).empty());
  // The volatile secure writer's are submessages that are encrypted themselves.
  EXPECT_TRUE(passed(Only(kDataId, Data({0xff, 2, 2, 0xc3}, {0, 1, 0, 0}), kWithPayload)).empty());

  // What comes before there are keys, and what is encrypted.
  const Datagram announcement = Announces({Parameter(0x15, {2, 2, 0, 0})});
  EXPECT_EQ(passed(announcement), announcement);
  EXPECT_EQ(passed(Handshake(1, 0)), Handshake(1, 0));
  const Datagram submessage = Only(0x31, {1, 2, 3, 4});
  EXPECT_EQ(passed(submessage), submessage);
  Datagram message = Only(0x33, {1, 2, 3, 4});
  AddSubmessage(&message, 0x30, {1, 2, 3, 4});
  AddSubmessage(&message, 0x34, {1, 2, 3, 4});
  EXPECT_EQ(passed(message), message);
  // Encrypted, and behind it a plain one in somebody else's name.
  Datagram behind = submessage;
  AddSubmessage(&behind, 0x0c, Datagram(20, 1));
  AddSubmessage(&behind, kDataId, Data(kWriter, {0, 1, 0, 0, 7, 7, 7, 7}), kWithPayload);
  EXPECT_EQ(passed(behind), submessage);
}

TEST(DatagramFilter, LengthsThatLeaveTheDatagramAreDropped) {
  const Datagram sample = Sample();
  for (std::size_t size = 0; size < sample.size(); ++size) {
    EXPECT_TRUE(IsDropped({sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(size)}))
        << size;
  }
}

TEST(DatagramFilter, AWriterWithoutAnIdentifierIsDropped) {
  EXPECT_TRUE(IsDropped(Only(kDataId, Data({0, 0, 0, 0}, {0, 1, 0, 0, 7, 7, 7, 7}), kWithPayload)));
  EXPECT_TRUE(IsDropped(Only(kDataId, Data(kWriter, {0, 1, 0, 0}, 0), kWithPayload)));
  EXPECT_TRUE(IsDropped(Only(kDataId, Data(kWriter, {0, 1, 0, 0}), kWithPayload | 8)));
}

TEST(DatagramFilter, ParametersOfDiscoveryHoldWhatTheySay) {
  Datagram text, beyond, unended = {4, 0, 0, 0, 'a', 'b', 'c', 'd'}, endless, many;
  AddText(&text, "a");
  AddNumber(&beyond, 400, 4);        // a text longer than its parameter
  AddNumber(&endless, 1u << 30, 4);  // a list of a thousand million
  AddNumber(&many, 2, 4);
  Add(&many, text);
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x62, beyond)})));
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x62, unended)})));
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x29, endless)})));  // partitions
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x29, many)})));     // two, of which one is there
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x73, endless)})));  // representations
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x59, endless)})));  // properties
  EXPECT_TRUE(IsDropped(Announces({Parameter(0x1a, Datagram(8, 0))})));
  Datagram no_end = Announces({});
  no_end.resize(no_end.size() - 4);
  no_end[22] = static_cast<std::uint8_t>(no_end[22] - 4);
  EXPECT_TRUE(IsDropped(no_end));

  Datagram one;
  AddNumber(&one, 1, 4);
  Add(&one, text);
  EXPECT_TRUE(Passes(Announces({Parameter(0x29, one)})));
}

TEST(DatagramFilter, ParametersThatNobodyNeedsAreBlanked) {
  const Datagram kept = Parameter(0x15, {2, 2, 0, 0});
  const Datagram type_object = Parameter(0x72, Datagram(8, 0xff));
  const Datagram datagram = Announces({type_object, kept});
  Datagram expected = datagram;
  expected[48] = expected[49] = 0;  // header 20, submessage 4, DATA 20, encapsulation 4
  EXPECT_EQ(datagram[48], 0x72);
  EXPECT_EQ(Passed(datagram), expected);

  Datagram token;  // of DDS security, which nobody has here
  AddText(&token, "DDS:Auth:PKI-DH:1.0");
  AddNumber(&token, 0, 4);
  AddNumber(&token, 0, 4);
  const Datagram with_token = Announces({Parameter(0x1001, token)});
  EXPECT_NE(Passed(with_token), with_token);
  EXPECT_EQ(Passed(with_token, true), with_token);
  Datagram bad;
  AddText(&bad, "DDS:Auth:PKI-DH:1.0");
  AddNumber(&bad, 0x7fffffff, 4);
  AddNumber(&bad, 0, 4);
  EXPECT_TRUE(Passed(Announces({Parameter(0x1001, bad)}), true).empty());
}

TEST(DatagramFilter, MessagesOfAHandshakeHoldWhatTheySay) {
  EXPECT_TRUE(Passes(Handshake(1, 0)));
  EXPECT_TRUE(IsDropped(Handshake(1u << 28, 0)));
  EXPECT_TRUE(IsDropped(Handshake(2, 0)));
  EXPECT_TRUE(IsDropped(Handshake(1, 0x7fffffff)));
}

Datagram Fragment(std::uint32_t first, std::uint16_t count, std::uint16_t size,
                  std::uint32_t sample, std::size_t payload) {
  Datagram out;
  AddNumber(&out, 0, 2);
  AddNumber(&out, 28, 2);
  AddNumber(&out, 0, 4);
  Add(&out, kWriter);
  AddSequenceNumber(&out, 5);
  AddNumber(&out, first, 4);
  AddNumber(&out, count, 2);
  AddNumber(&out, size, 2);
  AddNumber(&out, sample, 4);
  out.resize(out.size() + payload);
  return Only(kFragmentId, out);
}

TEST(DatagramFilter, FragmentsLieInTheirSample) {
  EXPECT_TRUE(Passes(Fragment(1, 1, 1000, 2500, 1000)));
  EXPECT_TRUE(Passes(Fragment(3, 1, 1000, 2500, 500)));
  EXPECT_TRUE(IsDropped(Fragment(0, 1, 1000, 2500, 1000)));
  EXPECT_TRUE(IsDropped(Fragment(1, 1, 0, 2500, 1000)));
  EXPECT_TRUE(IsDropped(Fragment(1, 0, 1000, 2500, 1000)));
  EXPECT_TRUE(IsDropped(Fragment(4, 1, 1000, 2500, 1000)));
  EXPECT_TRUE(IsDropped(Fragment(3, 2, 1000, 2500, 1500)));
  EXPECT_TRUE(IsDropped(Fragment(1, 1, 1000, 2500, 900)));
  EXPECT_TRUE(IsDropped(Fragment(1, 1, 65535, 0xffffffff, 60000)));
  EXPECT_TRUE(IsDropped(Fragment(0xffffffff, 65535, 65535, 2500, 1000)));
}

Datagram Gap(std::uint64_t first, std::uint64_t base, std::uint32_t bits, std::size_t words) {
  Datagram out;
  AddNumber(&out, 0, 4);
  Add(&out, kWriter);
  AddSequenceNumber(&out, first);
  AddSequenceNumber(&out, base);
  AddNumber(&out, bits, 4);
  out.resize(out.size() + 4 * words);
  return Only(0x08, out);
}

TEST(DatagramFilter, GapsAndSetsAreOfBoundedSize) {
  EXPECT_TRUE(Passes(Gap(1, 1000, 32, 1)));
  EXPECT_TRUE(IsDropped(Gap(0, 1000, 32, 1)));
  EXPECT_TRUE(IsDropped(Gap(0x7fffffffffffffff, 1ull << 63, 32, 1)));  // before its first number
  EXPECT_TRUE(IsDropped(Gap(1, 1ull << 40, 32, 1)));                   // counted through one by one
  EXPECT_TRUE(IsDropped(Gap(1, 1000, 257, 9)));
  EXPECT_TRUE(IsDropped(Gap(1, 1000, 256, 7)));
}

// Under the address sanitizer: whatever the bytes, none beside them is read, and what passes
// passes again as it is.
TEST(DatagramFilter, WhateverTheBytesWhatPassesPassesAgain) {
  Datagram name, seed = Header();
  AddText(&name, "x");
  AddSubmessage(&seed, 0x09, Datagram(8, 1));
  AddSubmessage(&seed, kDataId,
                Announcement({Parameter(0x62, name), Parameter(0x29, {0, 0, 0, 0})}), kWithPayload);
  Add(&seed, std::span<const std::uint8_t>(Gap(1, 9, 32, 1)).subspan(20));
  Add(&seed, std::span<const std::uint8_t>(Fragment(1, 1, 8, 20, 8)).subspan(20));
  ASSERT_TRUE(Passes(seed));
  std::mt19937 random(1);
  int passed = 0;
  for (int round = 0; round < 200000; ++round) {
    Datagram bytes = seed;
    for (unsigned k = 0; k <= random() % 4; ++k) {
      bytes[20 + random() % (bytes.size() - 20)] =
          static_cast<std::uint8_t>(random() % 3 == 0 ? random() % 4 : random());
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    for (const bool secure : {false, true}) {
      const Datagram out = Passed(bytes, secure);
      if (out.empty()) continue;
      ++passed;
      ASSERT_LE(out.size(), bytes.size());
      ASSERT_EQ(Passed(out, secure), out) << round;
    }
  }
  EXPECT_GT(passed, 20000);
}

}  // namespace
}  // namespace sinew::node::internal

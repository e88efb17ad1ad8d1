#include "components/topics/node/matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Endpoint EndOf(bool is_writer, const EndpointQos& qos, const std::string& type = "T") {
  Endpoint endpoint;
  endpoint.is_writer = is_writer;
  endpoint.topic = "joint_state";
  endpoint.type_name = type;
  endpoint.qos = qos;
  return endpoint;
}

std::vector<std::string> Reasons(const EndpointQos& offered, const EndpointQos& requested) {
  return WhyNotMatched(EndOf(true, offered), EndOf(false, requested));
}

TEST(Matching, EqualTermsMatchAndMoreMayBeOffered) {
  using Durability = EndpointQos::Durability;
  const EndpointQos weak;
  const EndpointQos strong{true, Durability::kTransientLocal, false, 20ms};
  EXPECT_THAT(Reasons(weak, weak), IsEmpty());
  EXPECT_THAT(Reasons(strong, strong), IsEmpty());
  EXPECT_THAT(Reasons(strong, weak), IsEmpty());
}

TEST(Matching, EveryTermThatIsAskedForAndNotOfferedIsAReason) {
  using Qos = EndpointQos;
  struct Case {
    Qos offered, requested;
    std::string reason;
  };
  const std::vector<Case> cases = {
      {{.reliable = false},
       {.reliable = true},
       "reliability: the writer offers best-effort, the reader asks for reliable"},
      {{.durability = Qos::Durability::kVolatile},
       {.durability = Qos::Durability::kTransientLocal},
       "durability: the writer offers volatile, the reader asks for transient-local"},
      {{.deadline = kUnlimited},
       {.deadline = 20ms},
       "deadline: the writer offers none, the reader asks for 20 ms"},
      {{.deadline = 30ms},
       {.deadline = 20ms},
       "deadline: the writer offers 30 ms, the reader asks for 20 ms"},
      {{.latency_budget = 5ms},
       {.latency_budget = 1ms},
       "latency budget: the writer offers 5 ms, the reader asks for 1 ms"},
      {{.liveliness = Qos::Liveliness::kAutomatic},
       {.liveliness = Qos::Liveliness::kManualByTopic},
       "liveliness: the writer offers automatic, the reader asks for manual-by-topic"},
      {{.lease = kUnlimited},
       {.lease = 1s},
       "liveliness lease: the writer offers none, the reader asks for 1000 ms"},
      {{.by_source_stamp = false},
       {.by_source_stamp = true},
       "destination order: the writer offers by reception, the reader asks for by source stamp"},
      {{.access_scope = Qos::AccessScope::kInstance},
       {.access_scope = Qos::AccessScope::kGroup},
       "presentation: the writer offers instance, the reader asks for group"},
      {{.access_scope = Qos::AccessScope::kTopic},
       {.access_scope = Qos::AccessScope::kTopic, .coherent_access = true, .ordered_access = true},
       "presentation: the writer offers topic, the reader asks for topic coherent ordered"},
      {{.representations = {Qos::Representation::kXcdr2, Qos::Representation::kXcdr1}},
       {.representations = {}},
       "data representation: the writer offers XCDR2, the reader asks for XCDR1"},
  };
  for (const Case& one : cases) {
    EXPECT_THAT(Reasons(one.offered, one.requested), ElementsAre(one.reason));
    // All of these are ordered, so the other way round fits; a list of representations is not.
    if (one.offered.representations.empty()) {
      EXPECT_THAT(Reasons(one.requested, one.offered), IsEmpty()) << one.reason;
    }
  }
}

TEST(Matching, EveryTermThatDoesNotFitIsListed) {
  EXPECT_THAT(Reasons({}, {.reliable = true, .deadline = 20ms, .partitions = {"a"}}), SizeIs(3));
}

TEST(Matching, AReaderMayAcceptSeveralRepresentations) {
  using Representation = EndpointQos::Representation;
  EXPECT_THAT(Reasons({.representations = {}},
                      {.representations = {Representation::kXcdr2, Representation::kXcdr1}}),
              IsEmpty());
  EXPECT_THAT(Reasons({.representations = {}}, {.representations = {Representation::kXcdr2}}),
              ElementsAre("data representation: the writer offers XCDR1, the reader asks for "
                          "XCDR2"));
}

TEST(Matching, OwnershipMustBeEqualInBothDirections) {
  EXPECT_THAT(Reasons({.exclusive = true}, {.exclusive = false}),
              ElementsAre("ownership: the writer offers exclusive, the reader asks for shared"));
  EXPECT_THAT(Reasons({.exclusive = false}, {.exclusive = true}),
              ElementsAre("ownership: the writer offers shared, the reader asks for exclusive"));
}

TEST(Matching, PartitionsMeetByNameOrPattern) {
  const auto meet = [](std::vector<std::string> a, std::vector<std::string> b) {
    const EndpointQos one{.partitions = std::move(a)}, other{.partitions = std::move(b)};
    const bool matched = Reasons(one, other).empty();
    EXPECT_EQ(matched, Reasons(other, one).empty()) << "who writes is no matter";
    return matched;
  };
  EXPECT_TRUE(meet({}, {}));
  EXPECT_TRUE(meet({}, {""})) << "the default partition has an empty name";
  EXPECT_TRUE(meet({"left", "right"}, {"right"}));
  EXPECT_TRUE(meet({"robot_*"}, {"robot_1"}));
  EXPECT_TRUE(meet({"robot_?"}, {"robot_1"}));
  EXPECT_FALSE(meet({"robot_?"}, {"robot_12"}));
  EXPECT_FALSE(meet({"left"}, {"right"}));
  EXPECT_FALSE(meet({}, {"left"}));
  EXPECT_FALSE(meet({}, {"*"})) << "as Fast DDS has it";
  EXPECT_THAT(Reasons({.partitions = {"left", "right"}}, {}),
              ElementsAre("partition: the writer is in partitions 'left', 'right', the reader in "
                          "the default partition"));
}

TEST(Matching, WhatFastDdsDoesNotCompareIsNoReasonBetweenTwoOfItsParticipants) {
  Endpoint writer = EndOf(true, {.latency_budget = 5ms});
  Endpoint reader = EndOf(false, {.latency_budget = 1ms, .by_source_stamp = true});
  writer.guid = "01.0f.1|0.0.1.3";
  reader.guid = "01.0f.2|0.0.1.4";
  EXPECT_THAT(WhyNotMatched(writer, reader), IsEmpty());
  reader.guid = "01.10.2|0.0.1.4";  // Cyclone DDS compares everything
  EXPECT_THAT(WhyNotMatched(writer, reader), SizeIs(2));
}

TEST(Matching, OtherTypesNeverMatch) {
  EXPECT_THAT(WhyNotMatched(EndOf(true, {}, "A_1"), EndOf(false, {}, "A_2")),
              ElementsAre("type: the writer's is A_1, the reader's A_2"));
}

TEST(Matching, ReliabilityAndWhatIsNotTheDefaultOfDdsIsDescribedInOrder) {
  EXPECT_EQ(DescribeQos({}), "best-effort");
  EXPECT_EQ(DescribeQos({true, EndpointQos::Durability::kTransientLocal, true, 20ms}),
            "reliable, transient-local, exclusive, deadline 20 ms");
  EXPECT_EQ(DescribeQos({.liveliness = EndpointQos::Liveliness::kManualByTopic,
                         .lease = 500ms,
                         .partitions = {"left"}}),
            "best-effort, liveliness manual-by-topic, lease 500 ms, partition 'left'");
}

}  // namespace
}  // namespace sinew::node

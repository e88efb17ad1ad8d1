#include "components/node/matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

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
  using Durability = EndpointQos::Durability;
  EXPECT_THAT(Reasons({.reliable = false}, {.reliable = true}),
              ElementsAre("the writer offers best-effort, the reader asks for reliable"));
  EXPECT_THAT(
      Reasons({.durability = Durability::kVolatile}, {.durability = Durability::kTransientLocal}),
      ElementsAre("the writer offers volatile, the reader asks for transient-local"));
  EXPECT_THAT(Reasons({.deadline = kNoDeadline}, {.deadline = 20ms}),
              ElementsAre("the writer offers no deadline, the reader asks for deadline 20 ms"));
  EXPECT_THAT(Reasons({.deadline = 30ms}, {.deadline = 20ms}),
              ElementsAre("the writer offers deadline 30 ms, the reader asks for deadline 20 ms"));
}

TEST(Matching, OwnershipMustBeEqualInBothDirections) {
  EXPECT_THAT(Reasons({.exclusive = true}, {.exclusive = false}),
              ElementsAre("the writer offers exclusive ownership, the reader asks for shared"));
  EXPECT_THAT(Reasons({.exclusive = false}, {.exclusive = true}),
              ElementsAre("the writer offers shared ownership, the reader asks for exclusive"));
}

TEST(Matching, OtherTypesNeverMatch) {
  EXPECT_THAT(WhyNotMatched(EndOf(true, {}, "A_1"), EndOf(false, {}, "A_2")),
              ElementsAre("the writer's type is A_1, the reader's A_2"));
}

TEST(Matching, TermsAreDescribedInOrder) {
  EXPECT_EQ(DescribeQos({}), "best-effort, volatile");
  EXPECT_EQ(DescribeQos({true, EndpointQos::Durability::kTransientLocal, true, 20ms}),
            "reliable, transient-local, exclusive, deadline 20 ms");
}

}  // namespace
}  // namespace sinew::node

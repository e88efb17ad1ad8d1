// The rules of matching.h against Fast DDS itself. Domain 231. A program of its own: QoS profiles
// are loaded once a process.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string_view>

#include "components/base/config/config.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/matching.h"
#include "components/topics/node/node.h"
#include "tests/support/temporary_folder.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// The text of qos_profiles.xml with `terms` in a profile; `kind`: "data_writer", "data_reader".
std::string WithTerms(std::string xml, const std::string& kind, const std::string& profile,
                      const std::string& terms) {
  const std::size_t start = xml.find("<" + kind + " profile_name=\"" + profile + "\">");
  const std::string qos = "<qos>";
  if (start == std::string::npos) throw std::invalid_argument("no profile " + profile);
  return xml.insert(xml.find(qos, start) + qos.size(), terms);
}

std::string InPartition(const std::string& name) {
  return "<partition><names><name>" + name + "</name></names></partition>";
}

// announcement_period: of writers, shorter than the lease.
std::string Liveliness(const std::string& kind, const std::string& lease_s) {
  return "<liveliness><kind>" + kind + "</kind><lease_duration><sec>" + lease_s +
         "</sec></lease_duration><announcement_period><nanosec>500000000</nanosec>"
         "</announcement_period></liveliness>";
}

std::string LatencyBudget(const std::string& milliseconds) {
  return "<latencyBudget><duration><nanosec>" + milliseconds +
         "000000</nanosec></duration></latencyBudget>";
}

std::optional<Endpoint> FindEnd(const Node& node, std::string_view topic, bool is_writer) {
  for (const Endpoint& endpoint : node.Endpoints()) {
    if (endpoint.topic == topic && endpoint.is_writer == is_writer) return endpoint;
  }
  return std::nullopt;
}

TEST(MatchingDds, FastDdsMatchesWhatHasNoReasonAndNothingElse) {
  std::string xml =
      config::ReadFile(std::string(SINEW_SOURCE_DIR) + "/components/topics/node/qos_profiles.xml");
  // As between processes: participants of one process call each other, and may wait for each other.
  xml.insert(xml.find("<profiles>"),
             "<library_settings><intraprocess_delivery>OFF</intraprocess_delivery>"
             "</library_settings>");
  // Fits, although the latency budget does not.
  xml = WithTerms(xml, "data_writer", "state", InPartition("robot_*") + LatencyBudget("5"));
  xml = WithTerms(xml, "data_reader", "state", InPartition("robot_1") + LatencyBudget("1"));
  // Each of the others does not fit in one term.
  xml = WithTerms(xml, "data_writer", "control", Liveliness("AUTOMATIC", "2"));
  xml = WithTerms(xml, "data_reader", "control", Liveliness("AUTOMATIC", "1"));
  xml = WithTerms(xml, "data_reader", "event", InPartition("robot_1"));
  xml = WithTerms(xml, "data_reader", "latched", Liveliness("MANUAL_BY_TOPIC", "5"));
  xml = WithTerms(xml, "data_writer", "latched", Liveliness("AUTOMATIC", "5"));
  const testing::TemporaryFolder folder;
  const auto options = [path = folder.Write("qos.xml", xml)](const std::string& name) {
    Options made;
    made.component = made.name = name;
    made.domain_id = 231;
    made.mode = TimeMode::kRealtime;
    made.qos_path = path;
    return made;
  };
  Node reads(options("reads")), writes(options("writes")), watches(options("watches"));
  auto state_reader = reads.MakeReader(kJointState);
  auto control_reader = reads.MakeReader(kReference);
  auto event_reader = reads.MakeReader(kOperatorCommand);
  auto latched_reader = reads.MakeReader(kCommandSource);
  auto control_writer = writes.MakeWriter(kReference);
  auto event_writer = writes.MakeWriter(kOperatorCommand);
  auto latched_writer = writes.MakeWriter(kCommandSource);
  auto state_writer = writes.MakeWriter(kJointState);

  // Discovery reports the writers of a participant in order: after the last one all are decided.
  const auto limit = std::chrono::steady_clock::now() + 20s;
  const auto all_seen = [&] {
    const auto topics = {kJointState.name, kReference.name, kOperatorCommand.name,
                         kCommandSource.name};
    return std::all_of(topics.begin(), topics.end(), [&](const auto& topic) {
      return FindEnd(watches, topic, true) && FindEnd(watches, topic, false);
    });
  };
  while ((state_reader.matched_writers() == 0 || !all_seen()) &&
         std::chrono::steady_clock::now() < limit) {
    watches.WaitForData(20ms);
  }
  ASSERT_TRUE(all_seen());
  EXPECT_EQ(state_reader.matched_writers(), 1);
  EXPECT_EQ(control_reader.matched_writers(), 0);
  EXPECT_EQ(event_reader.matched_writers(), 0);
  EXPECT_EQ(latched_reader.matched_writers(), 0);

  const auto reasons = [&](const auto& topic) {
    return WhyNotMatched(*FindEnd(watches, topic.name, true), *FindEnd(watches, topic.name, false));
  };
  EXPECT_THAT(reasons(kJointState), IsEmpty());
  EXPECT_THAT(reasons(kReference),
              ElementsAre("liveliness lease: the writer offers 2000 ms, the reader asks for 1000 "
                          "ms"));
  EXPECT_THAT(reasons(kOperatorCommand),
              ElementsAre("partition: the writer is in the default partition, the reader in "
                          "partition 'robot_1'"));
  EXPECT_THAT(
      reasons(kCommandSource),
      ElementsAre("liveliness: the writer offers automatic, the reader asks for manual-by-topic"));
  EXPECT_THAT(DescribeQos(FindEnd(watches, kJointState.name, true)->qos),
              HasSubstr("latency budget 5 ms, partition 'robot_*'"));
}

}  // namespace
}  // namespace sinew::node

// The build with SINEW_ROS2_NAMES, whose names this program links in place of the node's own. The
// second process is of another implementation of DDS and knows the names of ROS 2 alone. Domains
// 226, 227.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>

#include <chrono>
#include <cstdlib>
#include <regex>
#include <string>

#include "components/topics/node/names.h"
#include "components/topics/node/node.h"
#include "tests/support/program.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

Options RosOptions(const std::string& name, int domain) {
  Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  options.mode = TimeMode::kRealtime;
  return options;
}

TEST(Ros2Names, AreThoseThatRos2GivesMessagesAndTopics) {
  // rosidl: PACKAGE::msg::dds_::TYPE_; ROS 2 design, "Topic and Service name mapping to DDS": rt/.
  static const std::regex kType("sinew::msg::dds_::[A-Z][A-Za-z]*_");
  for (const TopicInfo& topic : AllTopics()) {
    EXPECT_TRUE(std::regex_match(topic.dds_type_name, kType)) << topic.dds_type_name;
    EXPECT_EQ(internal::RegisteredTopicName(topic.name), "rt/" + topic.name);
  }
  EXPECT_EQ(FindTopic("joint_state")->dds_type_name, "sinew::msg::dds_::JointState_");
}

TEST(Ros2Names, APeerThatKnowsThemAloneHearsTheRobot) {
  ::setenv("CYCLONEDDS_URI", "file://" SINEW_SOURCE_DIR "/tests/install/cyclone/loopback.xml", 1);
  testing::Program listener({SINEW_TEST_BIN_DIR "/ros2_listener", "226"});
  Node node(RosOptions("world", 226));
  auto writer = node.MakeWriter(kJointState);
  msg::JointState state;
  state.joint_count = 1;
  state.position_rad[0] = 0.625;
  const auto end = std::chrono::steady_clock::now() + 10s;
  int code = testing::Program::kTimeout;
  while (code == testing::Program::kTimeout && std::chrono::steady_clock::now() < end) {
    EXPECT_EQ(writer.Write(state), WriteStatus::kOk);
    code = listener.Wait(20ms);
  }
  EXPECT_EQ(code, 0) << listener.error();
  EXPECT_THAT(listener.output(), HasSubstr("joints 1 position 0.625"));
}

TEST(Ros2Names, ProgramsOfSuchABuildHearEachOther) {
  Node a(RosOptions("a", 227)), b(RosOptions("b", 227));
  auto writer = a.MakeWriter(kJointState);
  auto reader = b.MakeReader(kJointState);
  msg::JointState state;
  state.joint_count = 1;
  std::optional<msg::JointState> heard;
  for (const auto end = std::chrono::steady_clock::now() + 10s;
       !heard && std::chrono::steady_clock::now() < end;) {
    EXPECT_EQ(writer.Write(state), WriteStatus::kOk);
    heard = reader.WaitNext(20ms);
  }
  EXPECT_TRUE(heard);
}

}  // namespace
}  // namespace sinew::node

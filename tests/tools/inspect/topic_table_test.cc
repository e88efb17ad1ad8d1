#include "tools/inspect/topic_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "components/topics/node/topics.h"

namespace sinew::inspect {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

std::vector<std::string> TableLines(const std::vector<TopicRow>& rows, std::size_t width) {
  std::istringstream in(FormatTopicTable(rows, width));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(TopicTable, EachWriterIsARowAndTheTypeStandsOnceForATopic) {
  EXPECT_THAT(TableLines({{"reference", "Reference", "sine", "best-effort", {"control"}, {}},
                          {"reference", "Reference", "file", "best-effort", {"control"}, {}},
                          {"imu", "Imu", "-", "-", {}, {}}},
                         80),
              ElementsAre("topic      type       writer  QoS          readers",
                          "reference  Reference  sine    best-effort  control",
                          "reference             file    best-effort  control",
                          "imu        Imu        -       -"));
}

TEST(TopicTable, AnotherTypeOfTheSameTopicIsShown) {
  EXPECT_THAT(
      TableLines({{"imu", "Imu", "a", "q", {}, {}}, {"imu", "Imu_0", "b", "q", {}, {}}}, 80),
      ElementsAre("topic  type   writer  QoS  readers",  //
                  "imu    Imu    a       q",             //
                  "imu    Imu_0  b       q"));
}

TEST(TopicTable, ReadersThatDoNotMatchFollowWithEveryReason) {
  EXPECT_THAT(
      TableLines({{"imu", "Imu", "world", "q", {"watch"}, {{"strict", {"one", "two"}}}}}, 80),
      ElementsAre("topic  type  writer  QoS  readers",  //
                  "imu    Imu   world   q    watch",    //
                  "  not matched: strict: one",         //
                  "  not matched: strict: two"));
}

TEST(TopicTable, ManyReadersGoOnBelowTheirColumnWithinTheWidth) {
  const std::vector<std::string> readers(9, "pneumatics");
  constexpr std::size_t kWidth = 62;  // 38 of them in front of the readers
  const auto lines = TableLines({{"joint_state", "JointState", "rig", "q", readers, {}}}, kWidth);
  ASSERT_THAT(lines, SizeIs(6)) << "a heading, then two names a line";
  EXPECT_EQ(lines[1], "joint_state  JointState  rig     q    pneumatics, pneumatics,");
  EXPECT_EQ(lines[5], std::string(38, ' ') + "pneumatics");
  for (const std::string& line : lines) EXPECT_LE(line.size(), kWidth);
}

TEST(TopicTable, TheTypeOfThisBuildIsShownAsInTheTableOfTopicsAndAnyOtherInFull) {
  const std::string registered = node::FindTopic("joint_state")->dds_type_name;
  EXPECT_EQ(DisplayedType("joint_state", registered), "JointState");
  EXPECT_EQ(DisplayedType("imu", registered), registered) << "of another topic";
  EXPECT_EQ(DisplayedType("joint_state", "sinew::msg::JointState_0"), "sinew::msg::JointState_0");
  EXPECT_EQ(DisplayedType("chatter", "std_msgs::msg::dds_::String_"),
            "std_msgs::msg::dds_::String_");
}

}  // namespace
}  // namespace sinew::inspect

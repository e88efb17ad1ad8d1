#include "components/topics/node/topics.h"

#include <gtest/gtest.h>
#include <sinew_idl/topic_types.h>

#include <fstream>
#include <map>
#include <set>
#include <sstream>

namespace sinew::node {
namespace {

// Rows "| a | b | ... |" of the first table of idl/README.md, by topic.
std::map<std::string, std::vector<std::string>> ReadTable() {
  std::ifstream file(std::string(SINEW_SOURCE_DIR) + "/idl/README.md");
  std::map<std::string, std::vector<std::string>> rows;
  std::string line;
  bool in_table = false;
  while (std::getline(file, line)) {
    if (line.rfind("| topic |", 0) == 0) in_table = true;
    if (!in_table) continue;
    if (line.empty()) break;
    std::vector<std::string> cells;
    std::stringstream stream(line);
    std::string cell;
    std::getline(stream, cell, '|');
    while (std::getline(stream, cell, '|')) {
      const auto begin = cell.find_first_not_of(' '), end = cell.find_last_not_of(' ');
      cells.push_back(begin == std::string::npos ? "" : cell.substr(begin, end - begin + 1));
    }
    rows[cells.at(0)] = cells;
  }
  rows.erase("topic");
  rows.erase("---");
  return rows;
}

TEST(Topics, TheHeaderForOtherImplementationsHasTheRegisteredNames) {
  EXPECT_EQ(AllTopicsHash(), SINEW_TOPICS_HASH);
  EXPECT_EQ(FindTopic("joint_state")->type_name + "_" + FindTopic("joint_state")->idl_hash,
            SINEW_TYPE_JOINT_STATE);
  EXPECT_EQ(FindTopic("joint_command")->type_name + "_" + FindTopic("joint_command")->idl_hash,
            SINEW_TYPE_JOINT_COMMAND);
}

TEST(Topics, AreThoseOfTheTableInTheReadme) {
  auto rows = ReadTable();
  for (const TopicInfo& topic : AllTopics()) {
    ASSERT_EQ(rows.count(topic.name), 1u) << topic.name;
    const auto& row = rows[topic.name];
    EXPECT_EQ("sinew::msg::" + row.at(1), topic.type_name);
    EXPECT_EQ(row.at(6), ProfileName(topic.profile)) << topic.name;
    rows.erase(topic.name);
  }
  EXPECT_TRUE(rows.empty()) << rows.begin()->first << " is in the table only";
}

TEST(Topics, CarryTheirFlattenedText) {
  for (const TopicInfo& topic : AllTopics()) {
    EXPECT_EQ(topic.idl.find("#include"), std::string::npos) << topic.name;
    EXPECT_NE(topic.idl.find("struct Header"), std::string::npos) << topic.name;
    const std::string name = topic.type_name.substr(topic.type_name.rfind(':') + 1);
    EXPECT_NE(topic.idl.find("struct " + name + " {"), std::string::npos) << topic.name;
    EXPECT_EQ(topic.idl_hash.size(), 8u);
  }
}

TEST(Topics, HaveTypeNamesThatDifferByHash) {
  std::set<std::string> names;
  for (const TopicInfo& topic : AllTopics()) names.insert(topic.dds_type_name);
  EXPECT_EQ(names.size(), AllTopics().size());
  EXPECT_EQ(FindTopic("joint_state")->dds_type_name,
            "sinew::msg::JointState_" + FindTopic("joint_state")->idl_hash);
  EXPECT_EQ(FindTopic("no_such_topic"), nullptr);
}

}  // namespace
}  // namespace sinew::node

// Every topic: a constant per topic (kJointState ...), and the table at run time.
//
// The constants are in topic_list.h, generated at build time from the table in idl/README.md. This
// header needs no DDS: messages are only declared here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "components/topics/node/topic.h"
#include "components/topics/node/topic_list.h"

namespace sinew::node {

// The table at run time, for recorders, `list` and tests.
struct TopicInfo {
  std::string name;
  std::string type_name;  // "sinew::msg::JointState"
  Profile profile;
  std::string idl;            // flattened text of its type
  std::string idl_hash;       // of that text without comments and blanks, 8 hex digits
  std::string dds_type_name;  // as registered: type_name + "_" + idl_hash, or the plain name
};
const std::vector<TopicInfo>& AllTopics();
const TopicInfo* FindTopic(std::string_view name);  // nullptr: no such topic
std::string AllTopicsHash();

}  // namespace sinew::node

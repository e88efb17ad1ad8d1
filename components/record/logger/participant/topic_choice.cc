#include "components/record/logger/participant/topic_choice.h"

#include <regex>
#include <set>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"

namespace sinew::logger {

namespace {

using TopicSet = std::set<const node::TopicInfo*>;

std::string NamesOfTopics() {
  return types::Joined(node::AllTopics(), ", ", &node::TopicInfo::name);
}

TopicSet Matching(const std::string& option, const std::string& entry) {
  if (const node::TopicInfo* topic = node::FindTopic(entry)) return {topic};
  TopicSet matching;
  try {
    const std::regex expression(entry);
    for (const node::TopicInfo& topic : node::AllTopics()) {
      if (topic.name != node::kRecordingProgress.name && std::regex_match(topic.name, expression)) {
        matching.insert(&topic);
      }
    }
  } catch (const std::regex_error& error) {
    throw UsageError(option + ": '" + entry + "' is no regular expression (" + error.what() +
                     "), expected one, or one of: " + NamesOfTopics());
  }
  if (matching.empty()) {
    throw UsageError(option + ": no topic '" + entry + "', expected one of: " + NamesOfTopics() +
                     "; or a regular expression that matches some");
  }
  return matching;
}

}  // namespace

std::vector<const node::TopicInfo*> ChooseTopics(const std::vector<std::string>& wanted,
                                                 const std::vector<std::string>& unwanted) {
  TopicSet in, out;
  for (const std::string& entry : wanted) in.merge(Matching("--topics", entry));
  for (const std::string& entry : unwanted) out.merge(Matching("--exclude", entry));
  if (wanted.empty()) {
    for (const node::TopicInfo& topic : node::AllTopics()) {
      if (topic.name != node::kRecordingProgress.name) in.insert(&topic);
    }
  }
  std::vector<const node::TopicInfo*> topics;  // in the order of the table
  for (const node::TopicInfo& topic : node::AllTopics()) {
    if (in.contains(&topic) && !out.contains(&topic)) topics.push_back(&topic);
  }
  if (topics.empty()) throw UsageError("--exclude: no topic is left to record");
  return topics;
}

}  // namespace sinew::logger

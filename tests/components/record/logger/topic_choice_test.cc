#include "components/record/logger/participant/topic_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "components/base/config/config.h"

namespace sinew::logger {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::vector<std::string> Chosen(const std::vector<std::string>& wanted,
                                const std::vector<std::string>& unwanted = {}) {
  std::vector<std::string> names;
  for (const node::TopicInfo* topic : ChooseTopics(wanted, unwanted)) names.push_back(topic->name);
  std::sort(names.begin(), names.end());
  return names;
}

std::string ChoiceError(const std::vector<std::string>& wanted,
                        const std::vector<std::string>& unwanted = {}) {
  try {
    (void)ChooseTopics(wanted, unwanted);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no error";
}

TEST(TopicChoice, IsEverythingButTheProgressByDefault) {
  EXPECT_EQ(Chosen({}).size(), node::AllTopics().size() - 1);
  EXPECT_THAT(Chosen({}), Not(Contains("recording_progress")));
  EXPECT_THAT(Chosen({".*"}), Not(Contains("recording_progress")));
  EXPECT_THAT(Chosen({"recording_progress"}), ElementsAre("recording_progress"));
}

TEST(TopicChoice, TakesNamesAndExpressionsOfWholeNames) {
  EXPECT_THAT(Chosen({"joint_state", "joint_state"}), ElementsAre("joint_state"));
  EXPECT_THAT(Chosen({"joint_.*", "imu"}), ElementsAre("imu", "joint_command", "joint_state"));
  EXPECT_THAT(ChoiceError({"joint"}), HasSubstr("--topics: no topic 'joint'"));
}

TEST(TopicChoice, LeavesOutWhatIsExcluded) {
  EXPECT_THAT(Chosen({"joint_.*"}, {".*_command"}), ElementsAre("joint_state"));
  EXPECT_THAT(Chosen({}, {"imu"}), AllOf(Not(Contains("imu")), Contains("joint_state")));
  EXPECT_THAT(ChoiceError({"imu"}, {"imu"}), HasSubstr("no topic is left"));
  EXPECT_THAT(ChoiceError({}, {"imo"}), HasSubstr("--exclude: no topic 'imo'"));
}

TEST(TopicChoice, RefusesABrokenExpression) {
  EXPECT_THAT(ChoiceError({"joint_["}), HasSubstr("'joint_[' is no regular expression"));
}

}  // namespace
}  // namespace sinew::logger

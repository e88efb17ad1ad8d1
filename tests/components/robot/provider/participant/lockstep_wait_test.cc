#include "components/robot/provider/participant/lockstep_wait.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>

#include "components/base/config/config.h"

namespace sinew::provider {
namespace {

using ::testing::HasSubstr;

// A topic whose answer count grows by one in each wait.
struct Growing {
  std::uint64_t answers = 0;
  int waits = 0;
  AwaitedTopic Topic(const std::string& text) {
    AwaitedTopic topic = ParseAwaited(text);
    topic.answers = [this] { return answers; };
    topic.wait = [this](std::chrono::microseconds) {
      ++waits;
      ++answers;
    };
    return topic;
  }
};

const LockstepWait::Caller kRunning{[] {}, [] { return false; }};

TEST(ParseAwaited, ReadsTopicAndWindow) {
  EXPECT_EQ(ParseAwaited("joint_command").topic, "joint_command");
  EXPECT_EQ(ParseAwaited("joint_command").window, 0u);
  EXPECT_EQ(ParseAwaited("recording_progress:128").topic, "recording_progress");
  EXPECT_EQ(ParseAwaited("recording_progress:128").window, 128u);
}

TEST(ParseAwaited, RefusesUnknownTopicsAndWindows) {
  for (const char* text : {"", "joint_comand", "joint_command:", "joint_command:-1",
                           "joint_command:129", "joint_command:x", ":1"}) {
    EXPECT_THROW(ParseAwaited(text), UsageError) << text;
  }
}

TEST(LockstepWait, ATickEndsWhenEveryTopicHasAnsweredIt) {
  Growing joints, valves;
  const LockstepWait wait({joints.Topic("joint_command"), valves.Topic("valve_command")}, 30.0);
  EXPECT_TRUE(wait.Answers(4, kRunning));
  EXPECT_EQ(joints.waits, 5) << "until tick 4 was answered, and no longer";
  EXPECT_EQ(valves.waits, 5);
  EXPECT_TRUE(wait.Answers(4, kRunning));
  EXPECT_EQ(joints.waits, 5);
}

TEST(LockstepWait, AWindowLetsTheAnswersLagUntilTheEnd) {
  Growing recorder;
  const LockstepWait wait({recorder.Topic("recording_progress:3")}, 30.0);
  EXPECT_TRUE(wait.Answers(2, kRunning));
  EXPECT_EQ(recorder.waits, 0) << "before its window nothing is awaited";
  EXPECT_TRUE(wait.Answers(5, kRunning));
  EXPECT_EQ(recorder.answers, 3u) << "tick 2";
  EXPECT_TRUE(wait.AllAnswers(5, kRunning));
  EXPECT_EQ(recorder.answers, 6u);
}

TEST(LockstepWait, TakesWhatArrivedBeforeItLooks) {
  std::uint64_t answers = 0;
  AwaitedTopic topic = ParseAwaited("joint_command");
  topic.answers = [&] { return answers; };
  topic.wait = [](std::chrono::microseconds) { FAIL() << "the answer was there already"; };
  const LockstepWait wait({topic}, 30.0);
  EXPECT_TRUE(wait.Answers(0, {[&] { answers = 1; }, [] { return false; }}));
}

TEST(LockstepWait, AStopRequestEndsTheWait) {
  Growing joints;
  const LockstepWait wait({joints.Topic("joint_command")}, 30.0);
  EXPECT_FALSE(wait.Answers(9, {[] {}, [&] { return joints.waits == 3; }}));
  EXPECT_EQ(joints.waits, 3);
}

TEST(LockstepWait, AnAnswerThatNeverComesIsAnErrorThatNamesTopicAndTick) {
  AwaitedTopic topic = ParseAwaited("valve_command:2");
  topic.answers = [] { return std::uint64_t{0}; };
  topic.wait = [](std::chrono::microseconds) {};
  const LockstepWait wait({topic}, 0.0);
  try {
    (void)wait.Answers(7, kRunning);
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("no valve_command for tick 5 within 0 s"));
  }
}

}  // namespace
}  // namespace sinew::provider

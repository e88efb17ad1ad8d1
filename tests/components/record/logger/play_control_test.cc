// Requests to a player: their text, and their way between two threads.
#include "components/record/logger/player/play_control.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "components/record/logger/player/pace.h"

namespace sinew::logger {
namespace {

using ::testing::HasSubstr;
using Kind = PlayRequest::Kind;
using namespace std::chrono_literals;

std::string RefusalOf(const std::string& line) {
  try {
    (void)ParsePlayRequest(line);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

TEST(PlayRequest, WordsAndTheirArguments) {
  EXPECT_EQ(ParsePlayRequest("pause").kind, Kind::kPause);
  EXPECT_EQ(ParsePlayRequest(" resume\n").kind, Kind::kResume);
  EXPECT_EQ(ParsePlayRequest("step").ticks, 1u);
  EXPECT_EQ(ParsePlayRequest("step 12").ticks, 12u);
  EXPECT_EQ(ParsePlayRequest("seek 12.5").kind, Kind::kSeek);
  EXPECT_EQ(ParsePlayRequest("seek 12.5").seconds, 12.5);
  EXPECT_EQ(ParsePlayRequest("seek +5").kind, Kind::kSeekBy);
  EXPECT_EQ(ParsePlayRequest("seek +5").seconds, 5.0);
  EXPECT_EQ(ParsePlayRequest("seek -5").seconds, -5.0);
  EXPECT_EQ(ParsePlayRequest("rate 0.1").rate, 0.1);
  EXPECT_EQ(ParsePlayRequest("rate max").rate, kMaxRate);
  EXPECT_EQ(ParsePlayRequest("quit").kind, Kind::kQuit);
}

TEST(PlayRequest, WhatIsWrongIsNamedWithWhatIsExpected) {
  EXPECT_THAT(RefusalOf(""), HasSubstr("expected pause"));
  EXPECT_THAT(RefusalOf("stop"), HasSubstr("'stop', expected pause"));
  EXPECT_THAT(RefusalOf("step 0"), HasSubstr("ticks from 1"));
  EXPECT_THAT(RefusalOf("step -3"), HasSubstr("ticks from 1"));
  EXPECT_THAT(RefusalOf("step 1.5"), HasSubstr("ticks from 1"));
  EXPECT_THAT(RefusalOf("seek here"), HasSubstr("seconds"));
  EXPECT_THAT(RefusalOf("seek nan"), HasSubstr("seconds"));
  EXPECT_THAT(RefusalOf("seek"), HasSubstr("expected"));
  EXPECT_THAT(RefusalOf("rate 0.05"), HasSubstr("at least 0.1, or max"));
  EXPECT_THAT(RefusalOf("rate inf"), HasSubstr("at least 0.1, or max"));
  EXPECT_THAT(RefusalOf("rate 1 2"), HasSubstr("expected"));
}

TEST(PlayRequest, FasterAndSlowerWalkASeriesThatEndsAtMaximum) {
  std::vector<double> up = {kLeastRate};
  while (up.back() != kMaxRate) up.push_back(FasterRate(up.back()));
  EXPECT_EQ(up, (std::vector<double>{0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, kMaxRate}));
  for (std::size_t i = up.size(); i-- > 1;) EXPECT_EQ(SlowerRate(up[i]), up[i - 1]);
  EXPECT_EQ(SlowerRate(kLeastRate), kLeastRate);
  EXPECT_EQ(FasterRate(kMaxRate), kMaxRate);
  EXPECT_EQ(FasterRate(1.5), 2.0);
  EXPECT_EQ(SlowerRate(1.5), 1.0);
}

TEST(PlayStatus, IsALineOfWordsWithUnits) {
  const PlayStatus status{1.25, 10.0, kMaxRate, true, false, 3, 42, 7, 9};
  EXPECT_EQ(FormatPlayStatus(status),
            "position_s=1.250 duration_s=10.000 rate=max paused=1 waiting=0 pass=3 messages=42 "
            "session_id=7 tick=9");
}

TEST(PlayControl, RequestsComeInOrderAndEachGetsItsReply) {
  PlayControl control;
  PlayRequest request;
  EXPECT_FALSE(control.Next(&request));
  control.Post(ParsePlayRequest("pause"));
  std::string reply;
  bool replied = false;
  std::thread client([&] { replied = control.Ask(ParsePlayRequest("step 4"), 10000ms, &reply); });
  int taken = 0;
  while (taken < 2) {
    control.WaitForRequest(10s);
    while (control.Next(&request)) {
      EXPECT_EQ(request.kind, taken == 0 ? Kind::kPause : Kind::kStep);
      control.Reply("reply " + std::to_string(++taken));
    }
  }
  client.join();
  EXPECT_TRUE(replied);
  EXPECT_EQ(reply, "reply 2");
}

TEST(PlayControl, AClientIsNotHeldUpByAPlayerThatHasEnded) {
  PlayControl control;
  std::string reply;
  bool replied = true;
  std::thread client([&] { replied = control.Ask(ParsePlayRequest("status"), 600s, &reply); });
  control.Close();
  client.join();
  EXPECT_FALSE(replied);
  EXPECT_FALSE(control.Ask(ParsePlayRequest("status"), 0ms, &reply));
}

}  // namespace
}  // namespace sinew::logger

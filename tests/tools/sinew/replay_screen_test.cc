#include "tools/sinew/replay_screen.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "components/record/logger/player/pace.h"

namespace sinew::tools {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<std::string> RequestsOf(const std::string& bytes) {
  KeyDecoder decoder;
  std::vector<std::string> requests;
  for (const char byte : bytes) {
    if (const auto request = decoder.Take(byte)) requests.push_back(*request);
  }
  for (const std::string& request : requests) (void)logger::ParsePlayRequest(request);
  return requests;
}

TEST(ReplayKeys, EachKeyIsARequest) {
  EXPECT_THAT(RequestsOf(" s+=-q"),
              ElementsAre("toggle", "step", "faster", "faster", "slower", "quit"));
  EXPECT_THAT(RequestsOf("xyz\n"), IsEmpty());
}

TEST(ReplayKeys, ArrowsSeekInBothModesOfTheTerminal) {
  EXPECT_THAT(RequestsOf("\x1b[C\x1b[D\x1b[A\x1b[B"),
              ElementsAre("seek +5", "seek -5", "seek +60", "seek -60"));
  EXPECT_THAT(RequestsOf("\x1bOC"), ElementsAre("seek +5"));
  EXPECT_THAT(RequestsOf("\x1b[1;5C"), ElementsAre("seek +5")) << "with control";
}

TEST(ReplayKeys, OtherSequencesAndTheEscapeKeyMeanNothing) {
  EXPECT_THAT(RequestsOf("\x1b[3~"), IsEmpty());
  EXPECT_THAT(RequestsOf("\x1bs"), ElementsAre("step"));
  EXPECT_THAT(RequestsOf("\x1b\x1b[D "), ElementsAre("seek -5", "toggle"));
}

TEST(ReplayLine, ShowsPositionRateAndWhetherItIsPaused) {
  logger::PlayStatus status;
  status.position_s = 15.0;
  status.duration_s = 60.0;
  status.rate = 2.0;
  status.paused = true;
  status.pass = 3;
  EXPECT_EQ(ReplayLine(status, 100),
            "15.0 of 60.0 s [#####---------------] x2 paused, pass 3  space s <- -> + - q");
  status.rate = logger::kMaxRate;
  EXPECT_THAT(ReplayLine(status, 100), HasSubstr("] max paused"));
}

TEST(ReplayLine, FitsAnyTerminalAndAnyRecording) {
  logger::PlayStatus status;
  EXPECT_EQ(ReplayLine(status, 10).size(), 10u);
  EXPECT_THAT(ReplayLine(status, 80), HasSubstr("0.0 of 0.0 s [####################]"));
  status.duration_s = 1.0;
  status.position_s = 9.0;
  EXPECT_THAT(ReplayLine(status, 80), HasSubstr("[####################]"));
  status.waiting = true;
  EXPECT_THAT(ReplayLine(status, 80), HasSubstr("waiting for readers"));
}

}  // namespace
}  // namespace sinew::tools

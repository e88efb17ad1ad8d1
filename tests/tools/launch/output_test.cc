#include "tools/launch/output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace sinew::launch {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> Split(const std::vector<std::string>& pieces) {
  std::vector<std::string> lines;
  LineSplitter splitter([&lines](std::string_view line) { lines.emplace_back(line); });
  for (const std::string& piece : pieces) splitter.Add(piece);
  splitter.Finish();
  return lines;
}

TEST(LineSplitter, GivesNothingForNothing) { EXPECT_THAT(Split({"", ""}), ElementsAre()); }

TEST(LineSplitter, JoinsPiecesOfALine) {
  EXPECT_THAT(Split({"on", "e\ntw", "o\n"}), ElementsAre("one", "two"));
}

TEST(LineSplitter, KeepsEmptyLinesAndTheLastLineWithoutEnd) {
  EXPECT_THAT(Split({"one\n\ntwo"}), ElementsAre("one", "", "two"));
}

TEST(LineSplitter, DropsCarriageReturns) { EXPECT_THAT(Split({"one\r\n"}), ElementsAre("one")); }

TEST(LineSplitter, CutsLinesOf64KiBWithoutLosingAByte) {
  const std::string big(200 * 1024, 'x');
  std::size_t total = 0;
  for (const std::string& line : Split({big + "\n", "end\n"})) {
    EXPECT_LE(line.size(), 64u * 1024u);
    total += line.size();
  }
  EXPECT_EQ(total, big.size() + 3);
}

TEST(LineSplitter, GivesTheSameLinesHoweverTheBytesAreCut) {
  const std::string text = "alpha\nbeta\n\ngamma\ndelta";
  const std::vector<std::string> whole = Split({text});
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    EXPECT_EQ(Split({text.substr(0, cut), text.substr(cut)}), whole) << "cut at " << cut;
  }
}

TEST(Output, PrefixesAreAlignedAndStreamsStayApart) {
  std::ostringstream out, error;
  Output output(out, error, false, {"a", "long"});
  output.FromProcess(0, false, "one");
  output.FromProcess(1, true, "two");
  output.Say("word");
  EXPECT_EQ(out.str(), "a    | one\n");
  EXPECT_EQ(error.str(), "long | two\nsinew launch: word\n");
}

TEST(Output, ColoursThePrefixOnlyWhenAsked) {
  std::ostringstream out, error;
  Output output(out, error, true, {"a", "b"});
  output.FromProcess(0, false, "one");
  output.FromProcess(1, false, "two");
  EXPECT_EQ(out.str(), "\x1b[36ma | \x1b[0mone\n\x1b[32mb | \x1b[0mtwo\n");
}

TEST(Output, ShowsControlCharactersOfAProcess) {
  std::ostringstream out, error;
  Output output(out, error, true, {"a\x1b[1m"});
  output.FromProcess(0, false, "one\x1b[2J\ttwo");
  output.Say("\x07");
  EXPECT_EQ(out.str(), "\x1b[36ma\\u001b[1m | \x1b[0mone\\u001b[2J\ttwo\n");
  EXPECT_EQ(error.str(), "sinew launch: \\u0007\n");
}

TEST(Output, ReportsThatItsReaderIsGone) {
  std::ostringstream out, error;
  Output output(out, error, false, {"a"});
  EXPECT_FALSE(output.broken());
  out.setstate(std::ios::badbit);
  EXPECT_TRUE(output.broken());
}

}  // namespace
}  // namespace sinew::launch

// Plots through gnuplot itself: a wrong script is refused there.
#include "tools/inspect/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/base/config/config.h"
#include "tools/inspect/run_tool.h"

namespace sinew::inspect {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

Curve Ramp(const std::string& name, double from, double to) {
  Curve curve{name, {}, {}};
  for (int i = 0; i <= 100; ++i) {
    curve.time_s.push_back(0.01 * i);
    curve.value.push_back(from + (to - from) * 0.01 * i);
  }
  return curve;
}

std::string Drawn(const std::string& script) {
  return OutputOf("gnuplot", "gnuplot-nox", {}, script);
}

TEST(Plot, InTheTerminalARampRisesFromLeftToRight) {
  const std::string text = Drawn(TerminalScript("joint_state", {Ramp("q[0]", 0.0, 1.0)}, 60, 20));
  EXPECT_THAT(text, HasSubstr("joint_state"));
  EXPECT_THAT(text, HasSubstr("q[0]"));
  std::vector<std::string> lines;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    lines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  // The frame's inside, without the key's line: higher lines hold later points.
  std::vector<std::size_t> columns;
  for (const std::string& line : lines) {
    const std::size_t point = line.find('*');
    if (point != std::string::npos && line.find("q[0]") == std::string::npos) {
      columns.push_back(point);
    }
  }
  ASSERT_GE(columns.size(), 5u) << text;
  EXPECT_TRUE(std::is_sorted(columns.rbegin(), columns.rend())) << text;
  for (const std::string& line : lines) EXPECT_LE(line.size(), 60u);
}

TEST(Plot, AsAFileItIsAPng) {
  const std::string png =
      Drawn(PngScript("it's joint_state", {Ramp("a_b[0]", 0.0, 1.0), Ramp("c", 1.0, -1.0)}));
  EXPECT_THAT(png, StartsWith("\x89PNG\r\n"));
  EXPECT_GT(png.size(), 4000u);
}

TEST(Plot, GapsAndCurvesWithoutPointsAreDrawn) {
  Curve gaps = Ramp("gaps", 0.0, 1.0);
  gaps.value[50] = std::nan("");
  gaps.value[51] = std::numeric_limits<double>::infinity();
  Curve none{"none", {0.0}, {std::nan("")}};
  EXPECT_THAT(Drawn(PngScript("t", {gaps, none})), StartsWith("\x89PNG"));
  EXPECT_THAT(Drawn(TerminalScript("t", {gaps, none}, 0, 0)), HasSubstr("gaps"));
}

TEST(RunTool, AbsentAndFailingProgramsAreErrors) {
  try {
    (void)OutputOf("sinew-no-such-program", "some-package", {});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("apt-get install some-package"));
  }
  EXPECT_THROW((void)OutputOf("gnuplot", "gnuplot-nox", {}, "plot nonsense(("), std::runtime_error);
}

}  // namespace
}  // namespace sinew::inspect

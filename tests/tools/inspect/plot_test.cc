// Plots through gnuplot itself: a wrong script is refused there.
#include "tools/inspect/plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "components/base/config/config.h"
#include "tools/inspect/run_tool.h"

namespace sinew::inspect {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

Curve Ramp(const std::string& field, double from, double to) {
  Curve curve = CurveOf("topic." + field, field);
  for (int i = 0; i <= 100; ++i) {
    curve.time_s.push_back(0.01 * i);
    curve.value.push_back(from + (to - from) * 0.01 * i);
  }
  return curve;
}

std::vector<std::string> PlotLines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Characters, of which those in braille have three bytes.
std::size_t Characters(const std::string& line) {
  return static_cast<std::size_t>(
      std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

// The dots in the columns of a drawing: from the top, for each column the row of the highest dot;
// -1: none. Four rows a line, two columns a character.
std::vector<int> HighestDots(const std::string& text) {
  std::vector<int> highest;
  const std::vector<std::string> lines = PlotLines(text);
  for (std::size_t l = 1; l < lines.size(); ++l) {  // the first is the key
    std::size_t column = 0;
    for (std::size_t at = 0; at < lines[l].size(); ++column) {
      if (static_cast<unsigned char>(lines[l][at]) != 0xe2) {
        ++at;
        continue;
      }
      const unsigned bits = (static_cast<unsigned>(lines[l][at + 1]) & 0x3) << 6 |
                            (static_cast<unsigned>(lines[l][at + 2]) & 0x3f);
      at += 3;
      static constexpr unsigned kBits[2][4] = {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}};
      for (std::size_t side = 0; side < 2; ++side) {
        highest.resize(std::max(highest.size(), 2 * column + side + 1), -1);
        int& best = highest[2 * column + side];
        for (int row = 0; row < 4 && best < 0; ++row) {
          if ((bits & kBits[side][row]) != 0) best = 4 * static_cast<int>(l) + row;
        }
      }
    }
  }
  return highest;
}

TEST(CurveOf, TheAxisIsNamedByTheFieldWithItsUnit) {
  const Curve curve = CurveOf("joint_state.velocity_rad_s[3]", "velocity_rad_s[3]");
  EXPECT_EQ(curve.quantity, "velocity");
  EXPECT_EQ(curve.unit, "rad/s");
  EXPECT_EQ(CurveOf("a", "header.tick").quantity, "tick");
  EXPECT_EQ(CurveOf("a\x1b[2J", "x").name.find('\x1b'), std::string::npos);
}

// A period of a sine over 200 columns of dots: the dots are where the sine is, to one dot.
TEST(Plot, InTheTerminalASineIsWhereItsValuesAre) {
  Curve sine = CurveOf("joint_state.position_rad[0]", "position_rad[0]");
  for (int i = 0; i <= 2000; ++i) {
    sine.time_s.push_back(1e-3 * i);
    sine.value.push_back(std::sin(M_PI * 1e-3 * i));
  }
  const std::string text = DrawnInTerminal({sine}, {112, 30, false});
  const std::vector<std::string> lines = PlotLines(text);
  ASSERT_EQ(lines.size(), 30u) << text;
  EXPECT_EQ(lines[0], "position, rad   \u28ff joint_state.position_rad[0]");
  EXPECT_THAT(lines.back(), HasSubstr("time, s"));
  EXPECT_THAT(text, Not(HasSubstr("\x1b")));
  for (const std::string& line : lines) EXPECT_LE(Characters(line), 112u) << line;
  const std::vector<int> dots = HighestDots(text);
  // The frame: columns 10 to 109 of characters, lines 1 to 27; the axis from -1.1 to 1.1.
  for (int k = 2; k < 198; ++k) {
    const double time_s = (k - 0.5) / 198.0 * 2.0;
    const double row = 4.0 * (1.5 + (1.1 - std::sin(M_PI * time_s)) / 2.2 * 26.0);
    ASSERT_LT(static_cast<std::size_t>(20 + k), dots.size()) << text;
    // Within a column the sine rises by up to 1.6 rows.
    EXPECT_NEAR(dots[static_cast<std::size_t>(20 + k)], row, 3.0) << k << "\n" << text;
  }
}

TEST(Plot, InTheTerminalCurvesOfOneUnitShareAPanelWhereColoursDistinguishThem) {
  const std::vector<Curve> curves = {Ramp("position_rad[0]", 0.0, 1.0),
                                     Ramp("target_position_rad[0]", 1.0, 0.0),
                                     Ramp("torque_Nm[0]", 0.0, 9.0)};
  const auto panels = [&](bool colours) {
    std::vector<std::string> names;
    for (const std::string& line : PlotLines(DrawnInTerminal(curves, {80, 60, colours}))) {
      if (line.find("\u28ff") != std::string::npos) names.push_back(line);
    }
    return names;
  };
  EXPECT_THAT(panels(false),
              ElementsAre("position, rad   \u28ff topic.position_rad[0]",
                          "target_position, rad   \u28ff topic.target_position_rad[0]",
                          "torque, Nm   \u28ff topic.torque_Nm[0]"));
  const std::vector<std::string> coloured = panels(true);
  ASSERT_EQ(coloured.size(), 2u);
  EXPECT_EQ(coloured[0],
            "rad   \x1b[36m\u28ff topic.position_rad[0]\x1b[0m   \x1b[33m\u28ff "
            "topic.target_position_rad[0]\x1b[0m");
  EXPECT_EQ(coloured[1], "torque, Nm   \x1b[32m\u28ff topic.torque_Nm[0]\x1b[0m");
}

TEST(Plot, AsAFileItIsAPngOrAnSvgWithUnits) {
  const std::vector<Curve> curves = {Ramp("velocity_rad_s[0]", 0.0, 1.0),
                                     Ramp("torque_Nm[0]", 1.0, -1.0)};
  const std::string png = DrawnPicture(curves, "png");
  EXPECT_THAT(png, StartsWith("\x89PNG\r\n"));
  EXPECT_GT(png.size(), 4000u);
  const std::string svg = DrawnPicture(curves, "svg", 600, 400);
  for (const char* part : {"width=\"600\" height=\"400\"", "velocity, rad/s", "torque, Nm",
                           "time, s", "topic.velocity_rad_s[0]"}) {
    EXPECT_THAT(svg, HasSubstr(part));
  }
}

// A spike of one sample of 100 000 is in the picture: its axis reaches there.
TEST(Plot, ASingleSampleIsNotLost) {
  Curve spike = CurveOf("a.torque_Nm", "torque_Nm");
  for (int i = 0; i < 100'000; ++i) {
    spike.time_s.push_back(1e-3 * i);
    spike.value.push_back(i == 77'777 ? 50.0 : 0.0);
  }
  EXPECT_THAT(DrawnPicture({spike}, "svg"), HasSubstr("> 50<"));
}

TEST(Plot, GapsAndCurvesWithoutPointsAreDrawn) {
  Curve gaps = Ramp("gaps", 0.0, 1.0);
  for (std::size_t i = 40; i < 60; ++i) gaps.value[i] = std::nan("");
  gaps.value[50] = std::numeric_limits<double>::infinity();
  gaps.value[51] = 1e308;
  Curve none = CurveOf("none", "none");
  none.time_s = {0.0};
  none.value = {std::nan("")};
  EXPECT_THAT(DrawnPicture({gaps, none}, "png"), StartsWith("\x89PNG"));
  EXPECT_THAT(DrawnPicture({none}, "svg"), HasSubstr("<svg"));
  EXPECT_THAT(DrawnInTerminal({gaps, none}, {0, 0, false}), HasSubstr("gaps"));
  const std::vector<int> dots = HighestDots(DrawnInTerminal({gaps}, {112, 30, false}));
  const auto drawn = [&](int from, int to) {
    return std::count_if(dots.begin() + 20 + from, dots.begin() + 20 + to,
                         [](int row) { return row >= 0; });
  };
  EXPECT_EQ(drawn(84, 116), 0) << "a gap of a fifth";
  EXPECT_GT(drawn(4, 70), 60);
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

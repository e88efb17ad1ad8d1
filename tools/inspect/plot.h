// Curves over time in the terminal and as picture files. Axes, ticks and pictures are gnuplot's
// (docs/decisions/0005); in the terminal the curves are drawn in braille, 2 x 4 dots a character,
// into gnuplot's frame, because the gnuplot of Debian 12 has no such terminal.
//
// Curves of one unit share a panel, but for those that are apart; the panels stand below each other
// over the same time.
#pragma once

#include <string>
#include <vector>

namespace sinew::inspect {

struct Curve {
  std::string name;  // in the key: "joint_state.position_rad[0]"
  std::vector<double> time_s, value;
  std::string quantity{}, unit{};  // of its axis: "position", "rad"
  bool apart = false;              // in a panel of its own
};

// A curve without points, its name without control characters; the axis is named by the field,
// "header.tick" or "position_rad[0]".
Curve CurveOf(const std::string& name, const std::string& field);

struct TerminalStyle {
  int columns = 80, rows = 24;  // at least 40 columns, and 10 rows a panel
  bool colours = false;         // without them each curve has a panel of its own
};

// Values that are not finite are gaps. Both throw UsageError without gnuplot, std::runtime_error
// when it fails.
std::string DrawnInTerminal(const std::vector<Curve>& curves, const TerminalStyle& style);
// Content of a file, "png" or "svg", in the style of the reports' pictures. width_px 0: 920;
// height_px 0: by the number of panels. Of many points between two pixels the least and the
// greatest are drawn.
std::string DrawnPicture(const std::vector<Curve>& curves, const std::string& format,
                         int width_px = 0, int height_px = 0);

}  // namespace sinew::inspect

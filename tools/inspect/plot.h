// Curves over time for a terminal or a PNG file, as scripts for gnuplot (docs/decisions/0005).
// Pure.
#pragma once

#include <string>
#include <vector>

namespace sinew::inspect {

struct Curve {
  std::string name;  // "position_rad[0]"
  std::vector<double> time_s, value;
};

// Prints text to standard output; columns and rows of the terminal, at least 40 x 10. Values that
// are not finite are gaps.
std::string TerminalScript(const std::string& title, const std::vector<Curve>& curves, int columns,
                           int rows);
// Prints a PNG of 920 x 420 pixels to standard output, in the style of the reports' pictures.
std::string PngScript(const std::string& title, const std::vector<Curve>& curves);

}  // namespace sinew::inspect

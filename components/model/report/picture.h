// A picture of a page, and the style that all of them share. Pure text.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace sinew::report {

// Colours: what was measured, the model before and after, and up to four further series.
inline constexpr const char* kMeasuredColour = "#4d4d4d";
inline constexpr const char* kBeforeColour = "#d95f02";
inline constexpr const char* kAfterColour = "#1b7f9e";
inline constexpr const char* kSeriesColours[] = {"#7a9a5b", "#8d5fa8", "#c9a227", "#b5525c"};

// Points in a panel; one that is not finite interrupts the line. Of more than 2500 every k-th is
// drawn.
struct Series {
  std::string name{};    // in the key; empty: not there
  std::string colour{};  // empty: by its place in the panel
  std::vector<double> x{}, y{};
  std::string style = "lines lw 1.2";  // gnuplot's
  std::vector<double> spread{};        // standard deviation of y, for styles with bars

  void Add(double at_x, double at_y) {
    x.push_back(at_x);
    y.push_back(at_y);
  }
};

struct Panel {
  std::string label;  // of its y axis
  std::vector<Series> series;
  std::string y_range = "*:*";  // gnuplot's
};

// Lines over one x, which the page draws where scripts run: zoom shows what a picture cannot.
struct Traces {
  std::string x_label;
  std::vector<double> x;        // ascending
  std::vector<Panel> panels;    // series without an x of their own, of as many y
  double from = 0.0, to = 0.0;  // of x, shown at first
};

// One picture as a gnuplot script that prints SVG; numbers stand in the script, photographs in PNG
// files that it names.
struct Picture {
  std::string title;
  std::string caption;
  std::string script;
  std::optional<Traces> traces{};  // what the page draws in place of it
};

// Panels of that height under each other, over the same x.
Picture Chart(const std::string& title, const std::string& caption, const std::string& x_label,
              int panel_px, const std::vector<Panel>& panels);

// The start of every other script: terminal, font, borders, grid, key. height in pixels, width is
// 920.
std::string PictureHead(int height);

// A number for a script's data block.
std::string PictureNumber(double value);

}  // namespace sinew::report

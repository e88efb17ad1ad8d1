// A picture of a page, and the style that all of them share. Pure text.
#pragma once

#include <string>

namespace sinew::report {

// One picture as a gnuplot script that prints SVG; numbers stand in the script, photographs in PNG
// files that it names.
struct Picture {
  std::string title;
  std::string caption;
  std::string script;
};

// Colours: what was measured, the model before and after, and up to four further series.
inline constexpr const char* kMeasuredColour = "#4d4d4d";
inline constexpr const char* kBeforeColour = "#d95f02";
inline constexpr const char* kAfterColour = "#1b7f9e";
inline constexpr const char* kSeriesColours[] = {"#7a9a5b", "#8d5fa8", "#c9a227", "#b5525c"};

// The start of every script: terminal, font, borders, grid, key. height in pixels, width is 920.
std::string PictureHead(int height);

// A number for a script's data block.
std::string PictureNumber(double value);

}  // namespace sinew::report

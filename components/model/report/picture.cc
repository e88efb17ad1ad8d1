#include "components/model/report/picture.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "components/base/types/text.h"

namespace sinew::report {

namespace {

// Pixels: a line of text above, the axis with its name below, a gap between panels.
constexpr double kAbove = 30.0, kBelow = 66.0, kGap = 18.0;

constexpr std::size_t kMostPoints = 2500;

std::string DataBlock(const std::string& name, const Series& series) {
  std::string out = name + " << EOD\n";
  const std::size_t step = std::max<std::size_t>(1, series.x.size() / kMostPoints);
  for (std::size_t i = 0; i < series.x.size(); i += step) {
    if (std::isfinite(series.x[i]) && std::isfinite(series.y[i])) {
      out += PictureNumber(series.x[i]) + " " + PictureNumber(series.y[i]);
      if (!series.spread.empty()) out += " " + PictureNumber(series.spread[i]);
    }
    out += "\n";
  }
  return out + "EOD\n";
}

// In quotes; those in the text, and line ends, would end gnuplot's string.
std::string Quoted(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\'' || c == '\n'; }, ' ');
  return "'" + text + "'";
}

std::string Colour(const Series& series, std::size_t place) {
  if (!series.colour.empty()) return series.colour;
  return place == 0   ? kMeasuredColour
         : place == 1 ? kAfterColour
                      : kSeriesColours[(place - 2) % std::size(kSeriesColours)];
}

// A block's part of the command `plot`.
std::string Plot(const std::string& block, const Series& series, std::size_t place) {
  return block + (series.spread.empty() ? " using 1:2" : " using 1:2:3") + " with " + series.style +
         " lc rgb '" + Colour(series, place) + "' " +
         (series.name.empty() ? "notitle" : "title " + Quoted(series.name));
}

}  // namespace

Picture Chart(const std::string& title, const std::string& caption, const std::string& x_label,
              int panel_px, const std::vector<Panel>& panels) {
  const double height = kAbove + kBelow + panel_px * static_cast<double>(panels.size());
  std::string data, plots, range;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  int number = 0;
  for (std::size_t p = 0; p < panels.size(); ++p) {
    const bool last = p + 1 == panels.size();
    const double top = height - kAbove - panel_px * static_cast<double>(p);
    plots += "set tmargin at screen " + PictureNumber(top / height) + "\nset bmargin at screen " +
             PictureNumber((top - panel_px + (last ? 0.0 : kGap)) / height) + "\n" +
             (last ? "set format x '%g'\nset xlabel " + Quoted(x_label) + "\n"
                   : std::string("set format x ''\nunset xlabel\n")) +
             "set ylabel " + Quoted(panels[p].label) + "\nset yrange [" + panels[p].y_range + "]\n";
    std::string curves;
    for (std::size_t s = 0; s < panels[p].series.size(); ++s) {
      const Series& series = panels[p].series[s];
      if (series.x.empty()) continue;
      const std::string block = "$d" + std::to_string(number++);
      data += DataBlock(block, series);
      for (const double x : series.x) {
        if (!std::isfinite(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
      }
      curves += (curves.empty() ? "plot " : ", ") + Plot(block, series, s);
    }
    plots += (curves.empty() ? "set yrange [0:1]\nplot 0 notitle" : curves) + "\n";
  }
  if (high > low) range = "set xrange [" + PictureNumber(low) + ":" + PictureNumber(high) + "]\n";
  return {title, caption,
          PictureHead(static_cast<int>(height)) + data + range +
              "set lmargin at screen 0.1\nset rmargin at screen 0.97\nset multiplot\n" + plots +
              "unset multiplot\n"};
}

std::string PictureNumber(double value) { return types::Text("%.7g", value); }

std::string PictureHead(int height) {
  return "set terminal svg size 920," + std::to_string(height) +
         " font 'DejaVu Sans,12' background '#ffffff' noenhanced\n"
         "set border 3 lc rgb '#888888'\n"
         "set tics nomirror out scale 0.5 textcolor rgb '#333333'\n"
         "set grid lc rgb '#e4e4e4' lw 0.8\n"
         "set key outside top right horizontal samplen 2\n";
}

}  // namespace sinew::report

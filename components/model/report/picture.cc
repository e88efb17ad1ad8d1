#include "components/model/report/picture.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace sinew::report {

namespace {

// Pixels: a line of text above, the axis with its name below, a gap between panels.
constexpr double kAbove = 30.0, kBelow = 66.0, kGap = 18.0;

std::string DataBlock(const std::string& name, const Series& series) {
  std::string out = name + " << EOD\n";
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    const bool shown = std::isfinite(series.x[i]) && std::isfinite(series.y[i]);
    out += shown ? PictureNumber(series.x[i]) + " " + PictureNumber(series.y[i]) + "\n" : "\n";
  }
  return out + "EOD\n";
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
             (last ? "set format x '%g'\nset xlabel '" + x_label + "'\n"
                   : std::string("set format x ''\nunset xlabel\n")) +
             "set ylabel '" + panels[p].label + "'\nset yrange [" + panels[p].y_range + "]\n";
    std::string curves;
    for (const Series& series : panels[p].series) {
      const std::string block = "$d" + std::to_string(number++);
      data += DataBlock(block, series);
      for (const double x : series.x) {
        if (!std::isfinite(x)) continue;
        low = std::min(low, x);
        high = std::max(high, x);
      }
      curves += (curves.empty() ? "plot " : ", ") + block + " using 1:2 with " + series.style +
                " lc rgb '" + series.colour + "' " +
                (series.name.empty() ? "notitle" : "title '" + series.name + "'");
    }
    plots += curves + "\n";
  }
  if (high > low) range = "set xrange [" + PictureNumber(low) + ":" + PictureNumber(high) + "]\n";
  return {title, caption,
          PictureHead(static_cast<int>(height)) + data + range +
              "set lmargin at screen 0.1\nset rmargin at screen 0.97\nset multiplot\n" + plots +
              "unset multiplot\n"};
}

std::string PictureNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.5g", value);
  return text;
}

std::string PictureHead(int height) {
  return "set terminal svg size 920," + std::to_string(height) +
         " font 'DejaVu Sans,12' background '#ffffff' noenhanced\n"
         "set border 3 lc rgb '#888888'\n"
         "set tics nomirror out scale 0.5 textcolor rgb '#333333'\n"
         "set grid lc rgb '#e4e4e4' lw 0.8\n"
         "set key outside top right horizontal samplen 2\n";
}

}  // namespace sinew::report

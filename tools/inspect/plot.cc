#include "tools/inspect/plot.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "components/model/report/picture.h"

namespace sinew::inspect {

namespace {

constexpr int kPngHeight = 420;  // pixels; the width of every picture is 920

// In single quotes of gnuplot, where only the quote itself needs care.
std::string Quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\'') out += c;
    out += c == '\n' ? ' ' : c;
  }
  return out + "'";
}

std::string DataBlocks(const std::vector<Curve>& curves) {
  std::string out;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    out += "$d" + std::to_string(i) + " << EOD\n";
    bool any = false;
    for (std::size_t row = 0; row < curves[i].value.size(); ++row) {
      if (!std::isfinite(curves[i].value[row])) {
        out += "\n";  // an empty line breaks the curve
        continue;
      }
      any = true;
      out += report::PictureNumber(curves[i].time_s[row]) + " " +
             report::PictureNumber(curves[i].value[row]) + "\n";
    }
    if (!any) out += "0 NaN\n";  // gnuplot refuses a block without points
    out += "EOD\n";
  }
  return out;
}

std::string Frame(const std::string& title) {
  return "set title " + Quoted(title) + " noenhanced\nset xlabel 'time, s'\n";
}

}  // namespace

std::string TerminalScript(const std::string& title, const std::vector<Curve>& curves, int columns,
                           int rows) {
  // gnuplot ends each line with a blank.
  std::string out = "set terminal dumb size " + std::to_string(std::max(columns, 40) - 1) + "," +
                    std::to_string(std::max(rows, 10)) +
                    " noenhanced\nset key outside top right horizontal width 2\n";
  out += Frame(title) + DataBlocks(curves) + "plot ";
  for (std::size_t i = 0; i < curves.size(); ++i) {
    out += (i > 0 ? ", " : "") + ("$d" + std::to_string(i)) + " using 1:2 with lines title " +
           Quoted(curves[i].name);
  }
  return out + "\n";
}

std::string PngScript(const std::string& title, const std::vector<Curve>& curves) {
  std::string out = report::PictureHead(kPngHeight);
  out += "set terminal pngcairo size 920," + std::to_string(kPngHeight) +
         " font 'DejaVu Sans,11' background '#ffffff' noenhanced\n";
  out += Frame(title) + DataBlocks(curves) + "plot ";
  std::vector<std::string> colours = {report::kAfterColour, report::kBeforeColour};
  colours.insert(colours.end(), std::begin(report::kSeriesColours),
                 std::end(report::kSeriesColours));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    out += (i > 0 ? ", " : "") + ("$d" + std::to_string(i)) +
           " using 1:2 with lines lw 1.6 lc rgb '" + colours[i % colours.size()] + "' title " +
           Quoted(curves[i].name);
  }
  return out + "\n";
}

}  // namespace sinew::inspect

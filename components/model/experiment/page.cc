#include "components/model/experiment/page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>

namespace sinew::experiment {
namespace {

constexpr std::size_t kMostPoints = 2500;

std::string Number(double value, const char* format) {
  char text[48];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

// In quotes; those in the text would end gnuplot's string.
std::string Quoted(const std::string& text) {
  std::string quoted(1, '\'');
  for (const char c : text) quoted += c == '\'' ? ' ' : c;
  quoted += '\'';
  return quoted;
}

void Append(std::string* text, std::initializer_list<std::string> parts) {
  for (const std::string& part : parts) *text += part;
}

}  // namespace

std::string FormatValue(double value) { return Number(value, "%.5g"); }

std::string FormatEstimate(const Quantity& quantity) {
  return FormatValue(quantity.estimate.value);
}

std::string FormatInterval(const Quantity& quantity) {
  if (!quantity.has_interval || quantity.estimate.half_width_95 <= 0.0) return "";
  return FormatValue(quantity.estimate.value - quantity.estimate.half_width_95) + " .. " +
         FormatValue(quantity.estimate.value + quantity.estimate.half_width_95);
}

std::string FormatTarget(const Quantity& quantity) {
  if (quantity.target_absolute) {
    return "within " + FormatValue(*quantity.target_absolute) + " " + quantity.unit;
  }
  if (quantity.target_share) {
    return "within " + FormatValue(100.0 * *quantity.target_share) + " %";
  }
  return "";
}

report::Picture MakePicture(const Figure& figure) {
  report::Picture picture{.title = figure.title, .caption = figure.caption, .script = {}};
  const bool space = !figure.z_label.empty();
  std::string& script = picture.script;
  script = report::PictureHead(space ? 480 : 340);
  Append(&script,
         {"set xlabel ", Quoted(figure.x_label), "\nset ylabel ", Quoted(figure.y_label), "\n"});
  if (space) Append(&script, {"set zlabel ", Quoted(figure.z_label), " rotate\nset view 62,40\n"});
  std::string plots;
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    const Series& series = figure.series[i];
    if (series.x.empty()) continue;
    std::string name("$d");
    name += std::to_string(i);
    script += name;
    script += " << EOD\n";
    const std::size_t step = std::max<std::size_t>(1, series.x.size() / kMostPoints);
    for (std::size_t k = 0; k < series.x.size(); k += step) {
      Append(&script,
             {report::PictureNumber(series.x[k]), " ", report::PictureNumber(series.y[k])});
      if (!series.z.empty()) Append(&script, {" ", report::PictureNumber(series.z[k])});
      script += "\n";
    }
    script += "EOD\n";
    const char* colour = i == 0   ? report::kMeasuredColour
                         : i == 1 ? report::kAfterColour
                                  : report::kSeriesColours[(i - 2) % 4];
    std::string style;
    if (space) {
      style = "with points pt 7 ps 0.2";
    } else if (figure.bars && !series.line) {
      style = "using 1:2:3 with yerrorbars pt 7 ps 0.6 lw 1.3";
    } else if (series.line) {
      style = "with lines lw 1.3";
    } else {
      style = "with points pt 7 ps 0.5";
    }
    Append(&plots, {plots.empty() ? "" : ", ", name, " ", style, " lc rgb '", colour, "' ",
                    series.name.empty() ? "notitle" : "title " + Quoted(series.name)});
  }
  if (plots.empty()) {
    script += "set yrange [0:1]\nplot 0 notitle\n";
  } else {
    Append(&script, {space ? "splot " : "plot ", plots, "\n"});
  }
  return picture;
}

report::Section MakeSection(const Result& result) {
  report::Section section;
  section.id = "experiment-" + result.experiment;
  section.title = result.title;
  section.paragraphs = result.remarks;
  for (const Quantity& quantity : result.quantities) {
    report::Comparison line;
    line.name = quantity.name;
    line.unit = quantity.unit;
    line.published = quantity.published ? FormatValue(*quantity.published) : "";
    line.source = quantity.source;
    line.ours = FormatEstimate(quantity);
    line.interval = FormatInterval(quantity);
    line.truth = quantity.truth ? FormatValue(*quantity.truth) : "";
    // A value listed only because it was published that way has no target.
    if (quantity.has_interval) {
      line.target = FormatTarget(quantity);
      line.met = quantity.Met();
    }
    line.remark = quantity.remark;
    section.comparisons.push_back(std::move(line));
  }
  for (const ResultTable& table : result.tables) {
    report::Table out;
    out.title = table.title;
    out.header = table.header;
    out.rows = table.rows;
    section.tables.push_back(std::move(out));
  }
  for (const Figure& figure : result.figures) section.pictures.push_back(MakePicture(figure));
  return section;
}

}  // namespace sinew::experiment

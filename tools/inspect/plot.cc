#include "tools/inspect/plot.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>
#include <utility>

#include "components/base/types/printable.h"
#include "components/base/types/unit_name.h"
#include "components/model/report/picture.h"
#include "tools/inspect/run_tool.h"

namespace sinew::inspect {

namespace {

// Characters around the border of a frame: numbers of the ticks, the name of the time.
constexpr int kLeft = 10, kRight = 2, kBelow = 2;
constexpr int kPanel_px = 324, kAround_px = 96;  // 420 for one panel, as the reports' pictures
constexpr double kLeft_px = 104.0;               // the axis' name and a number of seven digits
constexpr const char* kAnsiColours[] = {"\x1b[36m", "\x1b[33m", "\x1b[32m",
                                        "\x1b[35m", "\x1b[34m", "\x1b[31m"};
constexpr const char* kAnsiEnd = "\x1b[0m";

// gnuplot refuses axes that come near the largest double.
bool IsDrawn(double value) { return std::abs(value) < 1e300; }

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void Take(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  // Never empty and never a point; wider by a share of its width on both sides.
  Interval Wider(double share) const {
    if (!(low <= high)) return {0.0, 1.0};
    const double more = high > low ? share * (high - low) : low == 0.0 ? 1.0 : 0.1 * std::abs(low);
    return {low - more, high + more};
  }
  double ShareAt(double value) const { return (value - low) / (high - low); }
};

struct PlotPanel {
  std::string label;
  std::vector<const Curve*> curves;
};

// By unit, numbers without one by their quantity; or a panel for each curve.
std::vector<PlotPanel> PanelsOf(const std::vector<Curve>& curves, bool one_each) {
  std::vector<PlotPanel> panels;
  for (const Curve& curve : curves) {
    const auto shares = [&](const PlotPanel& panel) {
      const Curve& first = *panel.curves.front();
      return !one_each && !first.apart && !curve.apart && first.unit == curve.unit &&
             (!curve.unit.empty() || first.quantity == curve.quantity);
    };
    auto panel = std::find_if(panels.begin(), panels.end(), shares);
    if (panel == panels.end()) panel = panels.insert(panel, PlotPanel{});
    panel->curves.push_back(&curve);
  }
  for (PlotPanel& panel : panels) {
    const Curve& first = *panel.curves.front();
    const bool same = std::all_of(panel.curves.begin(), panel.curves.end(),
                                  [&](const Curve* c) { return c->quantity == first.quantity; });
    panel.label =
        !same ? first.unit : first.quantity + (first.unit.empty() ? "" : ", " + first.unit);
  }
  return panels;
}

Interval RangeOf(const PlotPanel& panel) {
  Interval range;
  for (const Curve* curve : panel.curves) {
    for (const double value : curve->value) {
      if (IsDrawn(value)) range.Take(value);
    }
  }
  return range.Wider(0.05);
}

// Lines of a frame without curves: border, ticks, the name of the time.
std::vector<std::string> FrameLines(const Interval& time, const Interval& value, int columns,
                                    int rows) {
  const auto range = [](const Interval& of) {
    return " [" + report::PictureNumber(of.low) + ":" + report::PictureNumber(of.high) + "]\n";
  };
  std::ostringstream script;
  script << "set terminal dumb size " << columns << "," << rows << " noenhanced\nset lmargin "
         << kLeft << "\nset rmargin " << kRight << "\nset tmargin 0\nset bmargin " << kBelow
         << "\nset xlabel 'time, s'\nset xrange" << range(time) << "set yrange" << range(value)
         << "plot NaN notitle\n";
  std::istringstream text(OutputOf("gnuplot", "gnuplot-nox", {}, script.str()));
  const std::string blank(static_cast<std::size_t>(columns), ' ');
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) {
    line.erase(std::remove(line.begin(), line.end(), '\f'), line.end());
    lines.push_back(line + blank);
  }
  lines.resize(static_cast<std::size_t>(rows), blank);
  return lines;
}

// Dots of curves over the characters of a frame, its border included.
class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns), rows_(rows), cells_(static_cast<std::size_t>(columns * rows)) {}

  void Draw(const Curve& curve, std::size_t number, const Interval& time, const Interval& value) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    double last_x = kNone, last_y = kNone;
    for (std::size_t i = 0; i < curve.value.size(); ++i) {
      if (!IsDrawn(curve.value[i])) last_x = kNone;
      if (!IsDrawn(curve.value[i])) continue;
      const double x = 2.0 * (0.5 + time.ShareAt(curve.time_s[i]) * (columns_ - 1));
      const double y = 4.0 * (0.5 + (1.0 - value.ShareAt(curve.value[i])) * (rows_ - 1));
      if (std::isnan(last_x)) {
        last_x = x;
        last_y = y;
      }
      const double steps = std::ceil(std::max({std::abs(x - last_x), std::abs(y - last_y), 1.0}));
      for (double k = 1.0; k <= steps; ++k) {
        Dot(last_x + (x - last_x) * k / steps, last_y + (y - last_y) * k / steps, number);
      }
      last_x = x;
      last_y = y;
    }
  }

  // A line of the frame from its border on, with what was drawn; empty characters keep the frame's.
  std::string Over(const std::string& frame, int row, bool colours) const {
    std::string out;
    const char* now = kAnsiEnd;
    for (int column = 0; column < columns_; ++column) {
      const Cell& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
      const char* wanted =
          colours && cell.dots != 0 ? kAnsiColours[cell.curve % std::size(kAnsiColours)] : kAnsiEnd;
      if (std::exchange(now, wanted) != wanted) out += wanted;
      if (cell.dots == 0) {
        out += frame[static_cast<std::size_t>(column)];
        continue;
      }
      // UTF-8 of U+2800 and the dots.
      out += '\xe2';
      out += static_cast<char>(0xa0 | (cell.dots >> 6));
      out += static_cast<char>(0x80 | (cell.dots & 0x3f));
    }
    return now == kAnsiEnd ? out : out + kAnsiEnd;
  }

 private:
  struct Cell {
    unsigned dots = 0;
    std::size_t curve = 0;
  };

  void Dot(double x, double y, std::size_t curve) {
    static constexpr unsigned kBits[2][4] = {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}};
    const int column = std::clamp(static_cast<int>(x), 0, 2 * columns_ - 1);
    const int row = std::clamp(static_cast<int>(y), 0, 4 * rows_ - 1);
    Cell& cell = cells_[static_cast<std::size_t>(row / 4 * columns_ + column / 2)];
    cell.dots |= kBits[column % 2][row % 4];
    cell.curve = curve;
  }

  const int columns_, rows_;
  std::vector<Cell> cells_;
};

// The name of the axis, then those of the curves in their colours, in lines that fit.
std::vector<std::string> KeyLines(const PlotPanel& panel, std::size_t first, std::size_t columns,
                                  bool colours) {
  std::vector<std::string> lines = {panel.label.substr(0, columns)};
  std::size_t used = lines.back().size();
  for (std::size_t i = 0; i < panel.curves.size(); ++i) {
    const std::string name = panel.curves[i]->name.substr(0, columns - 5);
    if (used + name.size() + 5 > columns) {
      lines.emplace_back();
      used = 0;
    }
    used += name.size() + 5;
    lines.back() += "   ";
    if (colours) lines.back() += kAnsiColours[(first + i) % std::size(kAnsiColours)];
    lines.back() += "\u28ff " + name + (colours ? kAnsiEnd : "");
  }
  return lines;
}

// At most about 2500 points, which is what a picture draws of a series: of each group of points the
// least, the greatest and a gap.
report::Series Thinned(const Curve& curve) {
  report::Series out;
  out.name = curve.name;
  const std::size_t group = 1 + curve.value.size() / 800;
  for (std::size_t begin = 0; begin < curve.value.size(); begin += group) {
    const std::size_t end = std::min(begin + group, curve.value.size());
    std::size_t least = end, greatest = end, gap = end;
    for (std::size_t i = begin; i < end; ++i) {
      if (!IsDrawn(curve.value[i])) {
        gap = i;
      } else {
        if (least == end || curve.value[i] < curve.value[least]) least = i;
        if (greatest == end || curve.value[i] > curve.value[greatest]) greatest = i;
      }
    }
    std::set<std::size_t> kept = {least, greatest, gap};
    kept.erase(end);
    for (const std::size_t i : kept) {
      const double value = curve.value[i];
      out.x.push_back(curve.time_s[i]);
      out.y.push_back(IsDrawn(value) ? value : std::numeric_limits<double>::quiet_NaN());
    }
  }
  // gnuplot refuses a block without points.
  if (std::none_of(out.y.begin(), out.y.end(), IsDrawn)) out.x.clear();
  return out;
}

}  // namespace

Curve CurveOf(const std::string& name, const std::string& field) {
  const std::string last = field.substr(field.rfind('.') + 1);
  const types::UnitName split = types::SplitUnit(last.substr(0, last.find('[')));
  return {types::Printable(name), {}, {}, split.stem, split.unit, false};
}

std::string DrawnInTerminal(const std::vector<Curve>& curves, const TerminalStyle& style) {
  const std::vector<PlotPanel> panels = PanelsOf(curves, !style.colours);
  Interval time;
  for (const Curve& curve : curves) {
    for (const double at : curve.time_s) time.Take(at);
  }
  time = time.Wider(0.0);
  const int columns = std::max(style.columns, 40);
  const int height = std::max(style.rows / std::max<int>(1, static_cast<int>(panels.size())), 10);
  std::string out;
  std::size_t number = 0;
  for (const PlotPanel& panel : panels) {
    const auto key = KeyLines(panel, number, static_cast<std::size_t>(columns), style.colours);
    for (const std::string& line : key) out += line + "\n";
    const int rows = std::max(height - static_cast<int>(key.size()), 8);
    const Interval value = RangeOf(panel);
    const auto lines = FrameLines(time, value, columns, rows);
    Canvas canvas(columns - kRight - kLeft, rows - kBelow);
    for (const Curve* curve : panel.curves) canvas.Draw(*curve, number++, time, value);
    for (int row = 0; row < rows; ++row) {
      std::string line = lines[static_cast<std::size_t>(row)];
      if (row < rows - kBelow) {
        line = line.substr(0, kLeft) + canvas.Over(line.substr(kLeft), row, style.colours);
      }
      out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
  }
  return out;
}

std::string DrawnPicture(const std::vector<Curve>& curves, const std::string& format, int width_px,
                         int height_px) {
  const std::vector<PlotPanel> drawn = PanelsOf(curves, false);
  // Outside, the keys of all panels share a line.
  const bool keys_inside = drawn.size() > 1 || curves.size() > 3;
  std::vector<report::Panel> panels;
  for (const PlotPanel& panel : drawn) {
    const Interval range = RangeOf(panel);
    const double above = keys_inside ? 0.15 * (range.high - range.low) : 0.0;
    panels.push_back(
        {panel.label,
         {},
         report::PictureNumber(range.low) + ":" + report::PictureNumber(range.high + above)});
    for (const Curve* curve : panel.curves) panels.back().series.push_back(Thinned(*curve));
  }
  if (width_px == 0) width_px = 920;
  if (height_px == 0) height_px = kAround_px + kPanel_px * static_cast<int>(panels.size());
  const int panel_px = std::max(1, (height_px - kAround_px) / static_cast<int>(panels.size()));
  std::string script = report::Chart("", "", "time, s", panel_px, panels).script;
  const std::size_t multiplot = script.find("set multiplot");
  script.insert(multiplot,
                std::string(keys_inside ? "set key inside top right vertical opaque\n" : "") +
                    "set lmargin at screen " +
                    report::PictureNumber(std::min(kLeft_px / width_px, 0.5)) + "\n");
  // The first line is the terminal of the reports.
  return OutputOf("gnuplot", "gnuplot-nox", {},
                  "set terminal " + (format == "png" ? std::string("pngcairo") : format) +
                      " size " + std::to_string(width_px) + "," + std::to_string(height_px) +
                      " font 'DejaVu Sans,11' background '#ffffff' noenhanced" +
                      script.substr(script.find('\n')));
}

}  // namespace sinew::inspect

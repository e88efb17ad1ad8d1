#include "tools/sinew/echo_plot.h"

#include <unistd.h>

#include <algorithm>
#include <stdexcept>

#include "tools/launch/output.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

EchoPlot::EchoPlot(const std::string& topic, const recording::IdlType& type,
                   const std::vector<std::string>& fields, double window_s)
    : window_s_(window_s) {
  for (const std::string& path : fields) {
    fields_.emplace_back(type, path);
    if (!fields_.back().type().is_number()) {
      throw std::invalid_argument("field '" + path + "' is a text, expected a number");
    }
    curves_.push_back(inspect::CurveOf(topic + "." + path, path));
  }
  if (recording::HasField(type, "header.stamp_ns")) stamp_.emplace(type, "header.stamp_ns");
}

void EchoPlot::Add(std::span<const std::byte> payload, std::int64_t arrival_ns) {
  const std::int64_t now_ns = stamp_ ? stamp_->AsInt(payload) : arrival_ns;
  std::vector<double> values;
  values.reserve(fields_.size());
  for (const recording::CdrField& field : fields_) values.push_back(field.AsDouble(payload));
  if (!first_ns_) first_ns_ = now_ns;
  const double time_s = static_cast<double>(now_ns - *first_ns_) * 1e-9;
  for (std::size_t i = 0; i < curves_.size(); ++i) {
    curves_[i].time_s.push_back(time_s);
    curves_[i].value.push_back(values[i]);
  }
  ++messages_;
  if (window_s_ <= 0.0) return;
  for (inspect::Curve& curve : curves_) {
    const auto keep = std::find_if(curve.time_s.begin(), curve.time_s.end(),
                                   [&](double at) { return at >= time_s - window_s_; });
    const auto old = keep - curve.time_s.begin();
    curve.time_s.erase(curve.time_s.begin(), keep);
    curve.value.erase(curve.value.begin(), curve.value.begin() + old);
  }
}

std::string DrawnHere(const std::vector<inspect::Curve>& curves, int columns, int rows) {
  const TerminalSize size = SizeOfTerminal(STDOUT_FILENO);
  return inspect::DrawnInTerminal(
      curves, {columns > 0 ? columns : size.columns, rows > 0 ? rows : size.rows - 2,
               launch::WantsColour(STDOUT_FILENO)});
}

}  // namespace sinew::tools

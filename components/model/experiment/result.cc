#include "components/model/experiment/result.h"

#include <cmath>

#include "components/base/types/text.h"

namespace sinew::experiment {

std::optional<bool> Quantity::Met() const {
  if (!truth || (!target_absolute && !target_share)) return std::nullopt;
  const double limit = target_absolute ? *target_absolute : *target_share * std::abs(*truth);
  return std::abs(estimate.value - *truth) <= limit;
}

Quantity Quantity::Published(double value, std::string where) const {
  Quantity out = *this;
  out.published = value;
  out.source = std::move(where);
  return out;
}

Quantity Quantity::Within(double absolute) const {
  Quantity out = *this;
  out.target_absolute = absolute;
  return out;
}

Quantity Quantity::WithinShare(double share) const {
  Quantity out = *this;
  out.target_share = share;
  return out;
}

Quantity Quantity::WithoutInterval() const {
  Quantity out = *this;
  out.has_interval = false;
  return out;
}

const Quantity* Result::Find(const std::string& id) const {
  for (const Quantity& quantity : quantities) {
    if (quantity.id == id) return &quantity;
  }
  return nullptr;
}

std::string FormatValue(double value) { return types::Text("%.5g", value); }

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
    line.ours = FormatValue(quantity.estimate.value);
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
  section.tables = result.tables;
  section.pictures = result.figures;
  return section;
}

}  // namespace sinew::experiment

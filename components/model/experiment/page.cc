#include "components/model/experiment/page.h"

#include "components/base/types/text.h"

namespace sinew::experiment {

std::string FormatValue(double value) { return types::Text("%.5g", value); }

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
  section.tables = result.tables;
  section.pictures = result.figures;
  return section;
}

}  // namespace sinew::experiment

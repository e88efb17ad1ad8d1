#include "tools/sinew/experiment_output.h"

#include <optional>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/experiment/result.h"
#include "components/model/experiment/rows.h"
#include "components/model/report/file/section_file.h"
#include "tools/sinew/printed.h"

namespace sinew::tools {

namespace fs = std::filesystem;
using experiment::Quantity;
using nlohmann::ordered_json;

namespace {

report::Section SectionOf(const ExperimentOutcome& done) {
  report::Section section = experiment::MakeSection(done.result);
  section.seconds = done.seconds;
  section.paragraphs.push_back("Data: " + done.source + ".");
  section.comparisons.insert(section.comparisons.end(), done.addition.comparisons.begin(),
                             done.addition.comparisons.end());
  section.tables.insert(section.tables.end(), done.addition.tables.begin(),
                        done.addition.tables.end());
  return section;
}

}  // namespace

void PrintOutcome(const ExperimentOutcome& done) {
  Print("%s\n", done.result.title.c_str());
  Print("  %-42s %12s %-27s %-10s %-10s\n", "", "value", "95 % interval", "published", "true");
  for (const Quantity& q : done.result.quantities) {
    const std::string label = q.name + (q.unit.empty() ? "" : ", " + q.unit);
    const auto met = q.has_interval ? q.Met() : std::nullopt;
    Print("  %-42s %12s %-27s %-10s %-10s %s\n", label.c_str(),
          experiment::FormatValue(q.estimate.value).c_str(), experiment::FormatInterval(q).c_str(),
          q.published ? experiment::FormatValue(*q.published).c_str() : "-",
          q.truth ? experiment::FormatValue(*q.truth).c_str() : "-",
          met ? (*met ? (experiment::FormatTarget(q) + ": met").c_str()
                      : (experiment::FormatTarget(q) + ": MISSED").c_str())
              : "");
  }
  for (const std::string& remark : done.result.remarks) Print("  %s\n", remark.c_str());
  for (const std::string& line : done.addition.lines) Print("  %s\n", line.c_str());
  for (const std::string& change : done.changes) Print("  model: %s\n", change.c_str());
  if (!done.ending.empty() && done.ending != "done") Print("  ended: %s\n", done.ending.c_str());
}

ordered_json ToJson(const ExperimentOutcome& done) {
  ordered_json quantities = ordered_json::array();
  for (const Quantity& q : done.result.quantities) {
    ordered_json entry = {
        {"id", q.id}, {"name", q.name}, {"unit", q.unit}, {"value", q.estimate.value}};
    entry["half_width_95"] =
        q.has_interval ? ordered_json(q.estimate.half_width_95) : ordered_json(nullptr);
    entry["trials"] = q.estimate.trials;
    entry["published"] = q.published ? ordered_json(*q.published) : ordered_json(nullptr);
    entry["true"] = q.truth ? ordered_json(*q.truth) : ordered_json(nullptr);
    if (const auto met = q.Met()) entry["target_met"] = *met;
    quantities.push_back(std::move(entry));
  }
  ordered_json json = {{"experiment", done.result.experiment},
                       {"source", done.source},
                       {"quantities", quantities},
                       {"simulated_s", done.simulated_s},
                       {"time_s", done.seconds}};
  if (!done.addition.json.is_null()) json.update(done.addition.json);
  if (!done.ending.empty()) json["end"] = done.ending;
  if (!done.changes.empty()) json["model_changes"] = done.changes;
  return json;
}

void WriteFiles(const ExperimentOutcome& done, const fs::path& folder) {
  report::WriteSection(folder, SectionOf(done));
  config::WriteFileAtomically(folder / "data.csv", experiment::FormatCsv(done.rows));
  config::WriteFileAtomically(folder / "result.json", types::JsonText(ToJson(done), 2) + "\n");
}

}  // namespace sinew::tools

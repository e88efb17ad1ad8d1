#include "components/model/close_loop/close_loop.h"

#include <chrono>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/close_loop/builders.h"
#include "components/model/report/file/report_file.h"
#include "components/model/report/file/section_file.h"
#include "components/record/recording/file/recording_path.h"

namespace sinew::close_loop {

namespace {

namespace fs = std::filesystem;

// Ranges of one file may not share rows; whole files are compared by their samples.
void RequireOtherRows(const std::vector<fs::path>& train, const std::vector<fs::path>& held_out) {
  for (const fs::path& a : held_out) {
    const recording::RecordingPath one = recording::ParseRecordingPath(a);
    for (const fs::path& b : train) {
      const recording::RecordingPath other = recording::ParseRecordingPath(b);
      std::error_code error;
      if (!one.range && !other.range) continue;
      if (!fs::equivalent(one.file, other.file, error) || error) continue;
      if (!one.range.value_or(recording::TimeRange{})
               .Overlaps(other.range.value_or(recording::TimeRange{}))) {
        continue;
      }
      throw UsageError(a.string() + ": held-out range shares rows with " + b.string() +
                       ", expected one that was not trained on");
    }
  }
}

}  // namespace

Result CloseLoop(const Options& options) try {
  const auto start = std::chrono::steady_clock::now();
  const Input input = LoadInput(options);
  RequireOtherRows(options.train, options.held_out);
  Result out;
  out.model = input.model;
  if (!input.model.robot.floating_base) {
    TraceJoints(options, input, &out);
    return out;
  }
  FitStanding(options, input, &out);
  out.stance->seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  out.page = report::MakePage(*out.stance);
  out.json = types::JsonText(report::ReportJson(*out.stance), 2) + "\n";
  return out;
} catch (const std::invalid_argument& error) {
  throw UsageError(error.what());
}

void Write(const Result& result, const fs::path& folder, const std::string& made) {
  std::vector<Result::Part> parts = result.parts;
  parts.push_back({"", result.page, result.json});
  std::vector<std::string> pages;
  pages.reserve(parts.size());
  for (Result::Part& part : parts) {
    part.page.made = made;
    pages.push_back(report::DrawnHtml(part.page));
  }
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const fs::path at = folder / parts[i].folder;
    std::error_code error;
    fs::create_directories(at, error);
    if (error) throw UsageError(at.string() + ": " + error.message() + ", expected a folder");
    config::WriteFileAtomically(at / "report.json", parts[i].json);
    config::WriteFileAtomically(at / "report.html", pages[i]);
  }
  if (result.assessed) actuator::SaveModelFile(folder / "model.yaml", result.model);
}

}  // namespace sinew::close_loop

#include "reproduction/paper/paper.h"

#include <algorithm>
#include <boost/process/args.hpp>
#include <boost/process/child.hpp>
#include <boost/process/exe.hpp>
#include <boost/process/io.hpp>
#include <chrono>
#include <set>

#include "components/base/config/config.h"
#include "components/model/report/file/section_file.h"
#include "reproduction/paper/page.h"

namespace sinew::reproduction {

namespace {

namespace fs = std::filesystem;
namespace bp = boost::process;

std::string Joined(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

std::vector<std::string> CommandOf(const PaperStep& step, const PaperOptions& options) {
  std::vector<std::string> command = options.quick ? step.quick : step.command;
  for (std::string& word : command) {
    const std::size_t at = word.find("{robots}");
    if (at != std::string::npos) word.replace(at, 8, options.robots.string());
  }
  return command;
}

// The last line that a failed command printed.
std::string LastLine(const fs::path& log) {
  std::string text = config::ReadFile(log, config::kLargestData);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::size_t at = text.rfind('\n');
  return at == std::string::npos ? text : text.substr(at + 1);
}

bool IsThere(const fs::path& folder, const std::string& command) {
  std::error_code error;
  return fs::exists(folder / "section.json", error) && fs::exists(folder / "command.txt", error) &&
         config::ReadFile(folder / "command.txt") == command + "\n";
}

PaperStepResult RunStep(const PaperStep& step, const PaperOptions& options) {
  PaperStepResult result;
  result.id = step.id;
  const fs::path folder = options.out / step.id;
  std::vector<std::string> command = CommandOf(step, options);
  const std::string text = Joined(command);
  if (!options.again && IsThere(folder, text)) {
    result.ok = result.was_there = true;
    return result;
  }
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) {
    throw UsageError(folder.string() + ": " + error.message() + ", expected a writable folder");
  }
  fs::remove(folder / "section.json", error);
  command.insert(command.end(), {"--out", folder.string()});
  const fs::path log = folder / "log.txt";
  const auto began = std::chrono::steady_clock::now();
  bp::child child(bp::exe = options.program.string(), bp::args = command,
                  bp::std_in<bp::null, (bp::std_out & bp::std_err)> log.string());
  child.wait();
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  if (child.exit_code() != 0) {
    result.cause = "exit code " + std::to_string(child.exit_code()) + ": " + LastLine(log);
  } else if (!fs::exists(folder / "section.json")) {
    result.cause = "it left no section";
  } else {
    config::WriteFileAtomically(folder / "command.txt", text + "\n");
    result.ok = true;
  }
  return result;
}

report::Section FailedSection(const PaperStepResult& result, const std::string& command) {
  report::Section section;
  section.id = result.id;
  section.title = result.id + ": failed";
  section.paragraphs = {"sinew " + command + ": " + result.cause};
  section.seconds = result.seconds;
  return section;
}

}  // namespace

PaperPlan LoadPaperPlan(const fs::path& file) {
  const config::Section root = config::Section::Load(file, "sinew-paper/1");
  PaperPlan plan;
  plan.title = root.Text("title");
  plan.introduction = root.Text("introduction");
  std::set<std::string> ids;
  for (const config::Section& entry : root.List("steps")) {
    PaperStep step;
    step.id = entry.Text("id");
    report::Section named;
    named.id = step.id;
    named.title = step.id;
    try {
      report::CheckSection(named);
    } catch (const std::invalid_argument&) {
      entry.Fail("id", "'" + step.id + "', expected a word of a-z, 0-9 and '-'");
    }
    if (!ids.insert(step.id).second) entry.Fail("id", "'" + step.id + "' is there twice");
    step.command = entry.TextsOr("command", {});
    if (step.command.empty()) entry.Fail("command", "missing, expected words of a sinew command");
    step.quick = entry.TextsOr("quick", {});
    plan.steps.push_back(std::move(step));
  }
  root.RejectUnknownKeys();
  return plan;
}

std::vector<PaperStepResult> MakePaper(const PaperPlan& plan, const PaperOptions& options,
                                       const PaperProgress& progress) {
  for (const std::string& id : options.only) {
    if (std::none_of(plan.steps.begin(), plan.steps.end(),
                     [&](const PaperStep& step) { return step.id == id; })) {
      std::vector<std::string> known;
      for (const PaperStep& step : plan.steps) known.push_back(step.id);
      throw UsageError("--only " + id + ": no such part, expected one of " + Joined(known));
    }
  }
  std::vector<const PaperStep*> steps;
  for (const PaperStep& step : plan.steps) {
    const bool wanted =
        options.only.empty() || std::count(options.only.begin(), options.only.end(), step.id) > 0;
    if (wanted && !(options.quick && step.quick.empty())) steps.push_back(&step);
  }
  std::vector<PaperStepResult> results;
  std::vector<report::Section> sections;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    const PaperStep& step = *steps[i];
    if (progress.begin)
      progress.begin(step, static_cast<int>(i) + 1, static_cast<int>(steps.size()));
    PaperStepResult result = RunStep(step, options);
    sections.push_back(result.ok ? report::ReadSection(options.out / step.id)
                                 : FailedSection(result, Joined(CommandOf(step, options))));
    sections.back().id = step.id;
    if (progress.end) progress.end(result);
    results.push_back(std::move(result));
  }
  config::WriteFileAtomically(options.out / "index.html",
                              FormatPage({plan.title, plan.introduction}, sections));
  return results;
}

}  // namespace sinew::reproduction

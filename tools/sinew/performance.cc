#include "tools/sinew/commands.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "tools/sinew/performance_section.h"
#include "tools/sinew/performance_sessions.h"
#include "tools/sinew/print_section.h"

namespace sinew::tools {

namespace {

struct PerformanceOptions {
  std::vector<std::string> files;
  MeasureOptions measure;
  std::string csv, out;
  bool json = false;
};

void RunPerformance(const PerformanceOptions& options) {
  const std::vector<MeasuredSession> list = MeasureRecordings(options.files, options.measure);
  const bool writes = !options.csv.empty() || !options.out.empty();
  if (writes && list.size() != 1) {
    throw UsageError("--csv, --out: " + std::to_string(list.size()) + " sessions, expected one");
  }
  if (!options.csv.empty()) {
    config::WriteFileAtomically(options.csv, PerformanceCsv(list.front()));
  }
  if (!options.out.empty()) {
    report::WriteSection(options.out, MakePerformanceSection(list.front(), "performance"));
  }
  nlohmann::ordered_json sessions = nlohmann::ordered_json::array();
  for (const MeasuredSession& session : list) {
    if (options.json) {
      sessions.push_back(PerformanceJson(session));
      continue;
    }
    const report::Section section = MakePerformanceSection(session, "performance");
    std::cout << section.title << '\n';
    for (const std::string& paragraph : section.paragraphs) std::cout << paragraph << '\n';
    std::cout.flush();
    PrintSection(section);
    std::fflush(stdout);
  }
  if (options.json) std::cout << types::JsonText(sessions, 2) << '\n';
}

}  // namespace

void AddPerformanceCommand(CLI::App& app) {
  auto options = std::make_shared<PerformanceOptions>();
  CLI::App* command = app.add_subcommand(
      "performance", "Sliding tracking errors, energies and settle times of a recorded robot");
  command->add_option("recordings", options->files, "Recordings")
      ->required()
      ->type_name("FILE.mcap");
  command->add_option("--config", options->measure.config, "Schema sinew-performance/1")
      ->required()
      ->type_name("FILE.yaml");
  command
      ->add_option("--event", options->measure.event_s,
                   "Settle times of the sliding errors after these seconds of each session")
      ->check(CLI::Range(0.0, 1e6));
  command
      ->add_option("--band", options->measure.band_rad,
                   "Settled: within this of the plateau, rad or m")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--csv", options->csv, "Sliding errors over time")->type_name("FILE.csv");
  command->add_option("--out", options->out, "Folder for the section of a page, with a picture");
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "What each energy means: docs/participants/performance.md.\n\n"
      "Examples:\n"
      "  sinew performance run.mcap --config robots/biped/performance.yaml\n"
      "  sinew performance run.mcap --config robots/biped/performance.yaml --event 18.5 --json");
  command->callback([options] { RunPerformance(*options); });
}

}  // namespace sinew::tools

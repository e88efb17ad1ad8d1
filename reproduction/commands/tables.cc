#include "reproduction/commands/tables.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "reproduction/module_tables/pressure_section.h"
#include "reproduction/module_tables/regime_section.h"
#include "reproduction/module_tables/rls_section.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"

namespace sinew::reproduction {
namespace {

namespace fs = std::filesystem;

struct TablesOptions {
  fs::path out;
  fs::path pneumatics;
  std::uint64_t seed = 1;
  long updates = 10'000'000;
  bool quick = false;
  bool json = false;
};

report::Section RegimeTables(const TablesOptions& options) {
  tools::ProgressBar bar("tables regime", "cases", 0);
  return MakeRegimeSection(acceptance::MeasureRegime(
      options.quick, options.seed,
      [&bar](std::size_t done, std::size_t all) { bar.Update(done, all); }));
}

report::Section PressureTables(const TablesOptions& options) {
  const fs::path file = options.pneumatics.empty() ? tools::ShippedRobotFile("rig/pneumatics.yaml")
                                                   : options.pneumatics;
  const pneumatics::ManagerConfig config = pneumatics::LoadPneumatics(file).joints.at(0);
  tools::ProgressBar bar("tables pneumatics", "cases", 0);
  return MakePressureSection(acceptance::MeasurePressure(config, options.quick, options.seed,
                                                         [&bar](std::size_t done, std::size_t all) {
                                                           bar.Update(done, all);
                                                         }),
                             config);
}

report::Section RlsTables(const TablesOptions& options) {
  const long updates = options.quick ? std::min(options.updates, 300'000L) : options.updates;
  const acceptance::BatchScore batch =
      acceptance::CompareWithBatch(options.quick ? 500 : 5000, options.seed);
  const acceptance::SoakScore soak = acceptance::Soak(updates, options.seed);
  return MakeRlsSection(batch, soak,
                        {acceptance::TimeUpdates(76, 12), acceptance::TimeUpdates(85, 1),
                         acceptance::TimeUpdates(207, 1)});
}

void PrintJson(const report::Section& section) {
  nlohmann::ordered_json lines = nlohmann::ordered_json::array();
  for (const report::Comparison& c : section.comparisons) {
    nlohmann::ordered_json line = {{"name", c.name},           {"unit", c.unit},
                                   {"published", c.published}, {"ours", c.ours},
                                   {"target", c.target},       {"remark", c.remark}};
    if (c.met) line["met"] = *c.met;
    lines.push_back(std::move(line));
  }
  nlohmann::ordered_json tables = nlohmann::ordered_json::array();
  for (const report::Table& table : section.tables) {
    tables.push_back({{"title", table.title}, {"header", table.header}, {"rows", table.rows}});
  }
  const nlohmann::ordered_json all = {
      {"id", section.id}, {"comparisons", lines}, {"tables", tables}};
  std::cout << types::JsonText(all, 2) << '\n';
}

CLI::App* AddModule(CLI::App* tables, const std::shared_ptr<TablesOptions>& options,
                    const std::string& name, const char* text,
                    const std::function<report::Section(const TablesOptions&)>& measure) {
  CLI::App* command = tables->add_subcommand(name, text);
  command->add_option("--out", options->out, "Folder for the section of a page");
  command->add_option("--seed", options->seed, "Seed of everything random")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "A part of the grid: a few seconds");
  command->add_flag("--json", options->json, "As JSON");
  command->footer("Example:\n  sinew tables " + name + " --quick --out results/" + name);
  command->callback([options, measure] {
    const auto start = std::chrono::steady_clock::now();
    report::Section section = measure(*options);
    section.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!options->out.empty()) report::WriteSection(options->out, section);
    options->json ? PrintJson(section) : tools::PrintSection(section);
  });
  return command;
}

}  // namespace

void AddTablesCommand(CLI::App& app) {
  CLI::App* tables = app.add_subcommand(
      "tables", "Tables of the page: what single modules reach on the surrogate");
  tables->require_subcommand(1);
  tables->footer("Example:\n  sinew tables regime --quick --out results/regime");
  const auto options = std::make_shared<TablesOptions>();
  AddModule(tables, options, "regime", "The regime detector against the truth", RegimeTables);
  AddModule(tables, options, "pneumatics", "Pressures held, faults reported", PressureTables)
      ->add_option("--config", options->pneumatics,
                   "Pressure manager, sinew-pneumatics/1; default: the rig's")
      ->check(CLI::ExistingFile);
  AddModule(tables, options, "rls", "Recursive least squares: batch, soak, time", RlsTables)
      ->add_option("--updates", options->updates, "Updates of the soak")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

}  // namespace sinew::reproduction

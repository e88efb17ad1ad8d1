#include "reproduction/commands/compare.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "components/config/config.h"
#include "components/report/file/section_file.h"
#include "reproduction/networks/comparison.h"
#include "reproduction/networks/comparison_text.h"
#include "reproduction/networks/cylinder.h"
#include "tools/sinew/progress.h"

namespace sinew::reproduction {
namespace {

struct CompareOptions {
  std::string table;
  std::string data;
  std::filesystem::path folder;
  std::filesystem::path out;
  int seeds = 10;
  int trials = 16;
  int threads = 2;
  std::uint64_t seed = 1;
  bool quick = false;
  bool json = false;
};

// 25 Hz: the pistons moved about 10 mm/s.
constexpr double kCylinderPeriod_s = 0.04;

ComparisonOptions ToComparison(const CompareOptions& options) {
  ComparisonOptions comparison;
  comparison.seeds = options.seeds;
  comparison.trials = options.trials;
  comparison.threads = options.threads;
  comparison.seed = options.seed;
  if (options.table.empty() == options.data.empty()) {
    throw UsageError("sinew compare: expected either --table 6.2, --table 6.4 or --data cylinder");
  }
  if (options.data == "cylinder") {
    if (options.folder.empty()) {
      throw UsageError(
          "sinew compare: --data cylinder without --folder, expected the folder of its CSV files");
    }
    comparison.task = networks::Task::kForce;
    comparison.runs = ReadCylinder(options.folder);
    comparison.period_s = kCylinderPeriod_s;
  } else {
    comparison.task = options.table == "6.2" ? networks::Task::kSea : networks::Task::kPea;
  }
  if (options.quick) {
    comparison.seeds = std::min(comparison.seeds, 3);
    comparison.trials = std::min(comparison.trials, 2);
    comparison.epochs = 200;
    comparison.fair_epochs = 30;
    comparison.patience = 10;
    comparison.curve_sets = 0;
    if (comparison.task == networks::Task::kPea) comparison.duration_s = 100.0;
    if (comparison.task == networks::Task::kForce) comparison.period_s = 0.16;
  }
  return comparison;
}

void Run(const CompareOptions& options) {
  const ComparisonOptions comparison = ToComparison(options);
  ComparisonResult result;
  try {
    tools::ProgressBar bar("compare", "trainings", 0);
    result = Compare(comparison, [&](std::size_t done, std::size_t total) {
      bar.Update(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(total));
    });
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  if (options.json) {
    std::cout << ComparisonJson(result).dump(2) << '\n';
  } else {
    std::cout << FormatComparison(result);
  }
  if (options.out.empty()) return;
  std::filesystem::create_directories(options.out);
  const std::string name =
      options.table.empty()
          ? "compare_" + options.data
          : std::string("compare_table_") + options.table[0] + "_" + options.table.substr(2);
  config::WriteFileAtomically(options.out / (name + ".txt"), FormatComparison(result));
  config::WriteFileAtomically(options.out / (name + ".json"),
                              ComparisonJson(result).dump(2) + "\n");
  report::WriteSection(options.out, ComparisonSection(result));
}

}  // namespace

void AddCompareCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("compare", "The published tables of networks beside ours");
  command->footer(
      "As published: the same sizes, epochs, batches and rate. Fair: the same search for every\n"
      "model, trained until the validation error stops falling. Example:\n"
      "  sinew compare --table 6.2 --out result\n"
      "  sinew compare --table 6.4 --quick\n"
      "  sinew compare --data cylinder --folder recordings/cylinder");
  auto options = std::make_shared<CompareOptions>();
  command->add_option("--table", options->table, "6.2 (inside the backlash) or 6.4 (outside)")
      ->check(CLI::IsMember({"6.2", "6.4"}));
  command->add_option("--data", options->data, "Measured data instead of the surrogate's")
      ->check(CLI::IsMember({"cylinder"}));
  command->add_option("--folder", options->folder,
                      "Of the measured data: CSV with time_s, x_mm, p_bar, F_N");
  command->add_option("--seeds", options->seeds, "Trainings of every model")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  command->add_option("--trials", options->trials, "Hyper-parameters tried a model, fair table")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "Trainings at a time")
      ->check(CLI::Range(1, 2))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of the first data set and training")
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "Fewer seeds, trials and epochs: about 20 s");
  command->add_option("--out", options->out, "Folder for the tables as text and JSON");
  command->add_flag("--json", options->json, "Result as JSON");
  command->callback([options] { Run(*options); });
}

}  // namespace sinew::reproduction

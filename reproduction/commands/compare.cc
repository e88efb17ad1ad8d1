#include "reproduction/commands/compare.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "reproduction/legs_table/legs_data.h"
#include "reproduction/network_tables/comparison.h"
#include "reproduction/network_tables/comparison_text.h"
#include "reproduction/network_tables/cylinder.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"

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
  std::filesystem::path recording;
  int domain_id = 0;
  bool quick = false;
  bool json = false;
};

// 25 Hz: the pistons moved about 10 mm/s.
constexpr double kCylinderPeriod_s = 0.04;
// The start of the chirp squat, for --quick.
constexpr double kQuickChirp_s = 40.0;

ComparisonOptions ToComparison(const CompareOptions& options) {
  ComparisonOptions comparison;
  comparison.seeds = options.seeds;
  comparison.trials = options.trials;
  comparison.threads = options.threads;
  comparison.seed = options.seed;
  if (options.table.empty() == options.data.empty()) {
    throw UsageError("sinew compare: expected either --table 6.2, 6.4, 6.5 or --data cylinder");
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

// Table 6.5: a recording of the whole robot instead of the surrogate's sets.
void RunLegs(const CompareOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::filesystem::path robot = tools::ShippedRobotFile("biped");
  if (options.recording.empty() && options.out.empty()) {
    throw UsageError(
        "sinew compare --table 6.5: expected --recording FILE, or --out FOLDER where the chirp "
        "squat is recorded");
  }
  LegsTableOptions table;
  table.seeds = options.quick ? 2 : options.seeds;
  table.trials = options.quick ? 2 : options.trials;
  if (options.quick) table.epochs = 10;
  table.threads = options.threads;
  table.seed = options.seed;
  LegsRecording chirp;
  chirp.robot = robot;
  chirp.folder = options.out;
  chirp.domain_id = options.domain_id;
  if (options.quick) chirp.duration_s = kQuickChirp_s;
  const std::filesystem::path file =
      options.recording.empty() ? RecordChirp(chirp) : options.recording;
  const std::vector<LegsData> data = ReadLegsData(file, robot);
  std::vector<LegsModel> models;
  tools::ProgressBar bar("compare", "trainings", 0);
  models = FillLegsTable(data, table, [&](std::size_t done, std::size_t total) {
    bar.Update(static_cast<std::uint64_t>(done), static_cast<std::uint64_t>(total));
  });
  bar.Finish();
  report::Section section = LegsSection(
      models, table,
      report::Text("Data: the chirp squat of the biped, recorded over DDS at 240 Hz: %zu training "
                   "and %zu test samples, the first 80 %% and the last 20 %%. Inputs: position, "
                   "velocity and acceleration of each joint; targets: the drives' torques.",
                   data.front().all.train.size(), data.front().all.test.size()));
  section.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!options.out.empty()) report::WriteSection(options.out, section);
  tools::PrintSection(section);
}

void Run(const CompareOptions& options) {
  if (options.table == "6.5") {
    RunLegs(options);
    return;
  }
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
    std::cout << types::JsonText(ComparisonJson(result), 2) << '\n';
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
                              types::JsonText(ComparisonJson(result), 2) + "\n");
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
      "  sinew compare --table 6.5 --out legs\n"
      "  sinew compare --data cylinder --folder recordings/cylinder");
  auto options = std::make_shared<CompareOptions>();
  command
      ->add_option("--table", options->table,
                   "6.2 (inside the backlash), 6.4 (outside) or 6.5 (biped)")
      ->check(CLI::IsMember({"6.2", "6.4", "6.5"}));
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
  command
      ->add_option("--recording", options->recording,
                   "Table 6.5: of the chirp squat, instead of recording it in --out")
      ->check(CLI::ExistingFile);
  command->add_option("--domain", options->domain_id, "Table 6.5: DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->envname("SINEW_DOMAIN")
      ->capture_default_str();
  command->add_flag("--json", options->json, "Result as JSON");
  command->callback([options] { Run(*options); });
}

}  // namespace sinew::reproduction

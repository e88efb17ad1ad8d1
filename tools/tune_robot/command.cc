#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"
#include "tools/tune_robot/trial_table.h"
#include "tools/tune_robot/tune_file.h"
#include "tools/tune_robot/tune_section.h"

namespace sinew::tune {
namespace {

namespace fs = std::filesystem;

struct Options {
  fs::path file, out;
  std::optional<int> trials;
  std::optional<std::uint64_t> seed;
  int threads = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  bool json = false;
};

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// Refusals by the parts of a trial are the files' fault.
template <class Work>
auto WithFile(const fs::path& file, const Work& work) {
  try {
    return work();
  } catch (const std::invalid_argument& error) {
    throw UsageError(file.string() + ": " + error.what());
  }
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UsageError(folder.string() + ": cannot be made: " + error.message());
}

TableHead HeadOf(const TuneFile& file) {
  TableHead head;
  head.trials = file.search.search.trials;
  head.seed = file.search.search.seed;
  for (const auto& [what, path] : file.inputs) head.inputs[what] = HashOfFile(path);
  return head;
}

void TunePid(const Options& options) {
  const fs::path path =
      options.file.empty() ? tools::ShippedRobotFile("biped/tune_pid.yaml") : options.file;
  TuneFile file = LoadTune(path);
  file.search.threads = options.threads;
  if (options.trials) file.search.search.trials = *options.trials;
  if (options.seed) file.search.search.seed = *options.seed;
  const Clock::time_point start = Clock::now();
  std::optional<TrialTable> table;
  if (!options.out.empty()) {
    MakeFolder(options.out);
    table.emplace(options.out / "trials.jsonl", HeadOf(file));
  }
  tools::ProgressBar bar("tune pid", "trials", 0);
  const auto run = [&file](const control::PidConfig& pid) {
    RobotTrialConfig trial = file.trial;
    for (control::JointControlConfig& joint : trial.control) joint.pid = pid;
    return RunRobotTrial(trial).score;
  };
  const GainSearchResult result = WithFile(path, [&] {
    return RunGainSearch(
        file.search, table ? table->known() : std::vector<GainTrial>{}, run,
        [&table](const GainTrial& trial) {
          if (table) table->Append(trial);
        },
        [&bar](std::size_t done, std::size_t total) { bar.Update(done, total); });
  });
  bar.Finish();
  const report::Section section = GainSection(result, SecondsSince(start));
  if (table) {
    table->Finish(result.trials);
    report::WriteSection(options.out, section);
  }
  if (table && result.best) {
    const std::string comment = report::Text(
        "PID gains of the least tracking error of %zu trials, found by\n"
        "`sinew tune pid %s`: MSE %s rad2 in process.",
        result.trials.size(), path.string().c_str(), report::Short(result.best->cost()).c_str());
    config::WriteFileAtomically(options.out / "control.yaml",
                                ControlText(file.control, result.best->pid, options.out, comment));
  }
  if (options.json) {
    std::cout << types::JsonText(GainJson(result), 2) << '\n';
  } else {
    tools::PrintSection(section);
  }
  if (!result.best) throw std::runtime_error("the robot fell or stopped with all gains");
}

void TunePressure(const Options& options) {
  const fs::path path =
      options.file.empty() ? tools::ShippedRobotFile("biped/tune_pressure.yaml") : options.file;
  PressureSweepConfig sweep = LoadPressureSweep(path);
  sweep.threads = options.threads;
  if (!options.out.empty()) MakeFolder(options.out);
  const Clock::time_point start = Clock::now();
  tools::ProgressBar bar("tune pressure", "pressures", 0);
  const std::vector<PressurePoint> points = WithFile(path, [&] {
    return SweepPressure(sweep,
                         [&bar](std::size_t done, std::size_t total) { bar.Update(done, total); });
  });
  bar.Finish();
  const report::Section section = PressureSection(sweep, points, SecondsSince(start));
  const std::string json = types::JsonText(PressureJson(sweep, points), 2) + "\n";
  if (!options.out.empty()) {
    report::WriteSection(options.out, section);
    config::WriteFileAtomically(options.out / "pressure.json", json);
  }
  if (options.json) {
    std::cout << json;
  } else {
    tools::PrintSection(section);
  }
  if (BestPressure(points) == nullptr) {
    throw std::runtime_error("the robot fell or stopped at all pressures");
  }
}

CLI::App* AddSubcommand(CLI::App* parent, const char* name, const char* what, const char* file,
                        const char* out, const std::shared_ptr<Options>& options) {
  CLI::App* command = parent->add_subcommand(name, what);
  command->add_option("file", options->file, file)->check(CLI::ExistingFile);
  command->add_option("--out", options->out, out);
  command->add_option("--threads", options->threads, "Trials at a time; the result is the same")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--json", options->json, "Result as JSON");
  return command;
}

}  // namespace

void AddTuneCommand(CLI::App& app) {
  CLI::App* tune = app.add_subcommand("tune", "PID gains and pressures of a robot, in simulation");
  tune->require_subcommand(1);
  tune->footer(
      "Examples:\n"
      "  sinew tune pid robots/biped/tune_pid.yaml --out tuned\n"
      "  sinew tune pressure robots/biped/tune_pressure.yaml --out pressures");
  const auto pid = std::make_shared<Options>();
  CLI::App* gains = AddSubcommand(
      tune, "pid", "PID gains by two-stage random search (Algorithm 2 of the source)",
      "Search, sinew-tune/1; default: the biped's",
      "Folder: trials.jsonl (the search goes on from it), control.yaml, section, pictures", pid);
  gains->footer(
      "Example:\n  sinew tune pid robots/biped/tune_pid.yaml --out tuned\n"
      "  sinew launch robots/biped/deploy_biped.yaml --set control.config=tuned/control.yaml");
  gains->add_option("--trials", pid->trials, "Draws in each stage, in place of the file's")
      ->check(CLI::Range(1, 1000000));
  gains->add_option("--seed", pid->seed, "Of the draws, in place of the file's");
  gains->callback([pid] { TunePid(*pid); });
  const auto pressure = std::make_shared<Options>();
  CLI::App* pressures = AddSubcommand(
      tune, "pressure", "Energies and peak torques over the pressure of pneumatic elements",
      "Sweep, sinew-pressure-sweep/1; default: the biped's",
      "Folder: pressure.json, section, pictures", pressure);
  pressures->footer(
      "Example:\n  sinew tune pressure robots/biped/tune_pressure.yaml --out pressures");
  pressures->callback([pressure] { TunePressure(*pressure); });
}

}  // namespace sinew::tune

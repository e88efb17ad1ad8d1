#include "tools/sinew/check.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "components/pneumatics/file/pneumatics_file.h"
#include "components/report/file/section_file.h"
#include "tools/check/pressure_check.h"
#include "tools/check/regime_grid.h"
#include "tools/check/residual_check.h"
#include "tools/check/rls_check.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"

namespace sinew::tools {
namespace {

namespace fs = std::filesystem;

struct CheckOptions {
  fs::path out;
  fs::path pneumatics;
  std::uint64_t seed = 1;
  long updates = 10'000'000;
  bool quick = false;
  bool json = false;
  bool strict = false;
};

report::Section CheckRegime(const CheckOptions& options) {
  check::RegimeGrid grid;
  std::vector<check::RegimeCase> cases = check::RegimeCases(options.quick);
  std::vector<check::SetupCase> setups = check::SetupCases(options.quick);
  ProgressBar bar("check regime", "cases", cases.size() + setups.size());
  std::uint64_t done = 0;
  for (check::RegimeCase& at : cases) {
    at.seed += 1000 * (options.seed - 1);
    grid.scores.push_back(check::RunRegimeCase(at));
    bar.Update(++done);
  }
  for (check::SetupCase& at : setups) {
    at.seed += 1000 * (options.seed - 1);
    grid.setups.push_back(check::RunSetupCase(at));
    bar.Update(++done);
  }
  grid.unknowns = check::RunUnknownCases();
  return check::MakeRegimeSection(grid);
}

report::Section CheckPressure(const CheckOptions& options) {
  const fs::path file =
      options.pneumatics.empty() ? ShippedRobotFile("rig/pneumatics.yaml") : options.pneumatics;
  const pneumatics::ManagerConfig config = pneumatics::LoadPneumatics(file).joints.at(0);
  check::PressureCheck all;
  std::vector<check::HoldCase> cases = check::HoldCases(options.quick);
  const std::vector<check::Breakage> breakages = check::Breakages();
  ProgressBar bar("check pneumatics", "cases", cases.size() + breakages.size());
  std::uint64_t done = 0;
  for (check::HoldCase& at : cases) {
    at.seed += 1000 * (options.seed - 1);
    all.holds.push_back(check::RunHoldCase(config, at));
    bar.Update(++done);
  }
  for (const check::Breakage breakage : breakages) {
    all.faults.push_back(check::RunFaultCase(config, breakage));
    bar.Update(++done);
  }
  return check::MakePressureSection(all, config);
}

report::Section CheckResidual(const CheckOptions& options) {
  const check::ResidualBench bench =
      check::LoadResidualBench(ShippedRobotFile("rig/surrogate_model.yaml").parent_path());
  std::vector<check::ResidualCase> changes = check::ResidualChanges(options.quick);
  std::vector<check::ResidualCase> hours = check::ResidualHours(options.quick);
  std::vector<check::ResidualScore> change_scores, hour_scores;
  ProgressBar bar("check residual", "runs", changes.size() + hours.size());
  std::uint64_t done = 0;
  for (check::ResidualCase& at : changes) {
    at.seed += 1000000 * (options.seed - 1);
    change_scores.push_back(check::RunResidualCase(bench, at));
    bar.Update(++done);
  }
  for (check::ResidualCase& at : hours) {
    at.seed += 1000000 * (options.seed - 1);
    hour_scores.push_back(check::RunResidualCase(bench, at));
    bar.Update(++done);
  }
  return check::MakeResidualSection(bench, change_scores, hour_scores);
}

report::Section CheckRls(const CheckOptions& options) {
  const long updates = options.quick ? std::min(options.updates, 300'000L) : options.updates;
  const check::BatchScore batch = check::CompareWithBatch(options.quick ? 500 : 5000, options.seed);
  const check::SoakScore soak = check::Soak(updates, options.seed);
  return check::MakeRlsSection(
      batch, soak,
      {check::TimeUpdates(76, 12), check::TimeUpdates(85, 1), check::TimeUpdates(207, 1)});
}

void AddModule(CLI::App* check, const std::shared_ptr<CheckOptions>& options, const char* name,
               const char* text, const std::function<report::Section(const CheckOptions&)>& run) {
  CLI::App* command = check->add_subcommand(name, text);
  command->add_option("--out", options->out, "Folder for the section of a page");
  command->add_option("--seed", options->seed, "Seed of everything random")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "A part of the grid: a few seconds");
  command->add_flag("--json", options->json, "As JSON");
  command->add_flag("--strict", options->strict, "Exit code 1 when a target was missed");
  const std::string word = name;
  if (word == "pneumatics") {
    command
        ->add_option("--config", options->pneumatics,
                     "Pressure manager, sinew-pneumatics/1; default: the rig's")
        ->check(CLI::ExistingFile);
  } else if (word == "rls") {
    command->add_option("--updates", options->updates, "Updates of the soak")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
  }
  command->footer("Example:\n  sinew check " + word + " --quick --out results/" + word);
  command->callback([options, run] {
    const auto start = std::chrono::steady_clock::now();
    report::Section section = run(*options);
    section.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!options->out.empty()) report::WriteSection(options->out, section);
    options->json ? PrintSectionJson(section) : PrintSection(section);
    if (options->strict && !AllMet(section)) throw CLI::RuntimeError(1);
  });
}

}  // namespace

void AddCheckCommand(CLI::App& app) {
  CLI::App* check =
      app.add_subcommand("check", "What a module must reach, measured on the surrogate");
  check->require_subcommand(1);
  check->footer("Example:\n  sinew check regime --quick --out results/regime");
  const auto options = std::make_shared<CheckOptions>();
  AddModule(check, options, "regime", "The regime detector against the truth", CheckRegime);
  AddModule(check, options, "residual", "Changes reported in time, no false alarms", CheckResidual);
  AddModule(check, options, "pneumatics", "Pressures held, faults reported", CheckPressure);
  AddModule(check, options, "rls", "Recursive least squares: batch, soak, time", CheckRls);
}

}  // namespace sinew::tools

#include "reproduction/commands/control_test.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/report/file/section_file.h"
#include "reproduction/control_test/section.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/shipped.h"

namespace sinew::reproduction {
namespace {

namespace fs = std::filesystem;
using control_test::Arm;
using control_test::Load;
using control_test::Outcome;
using control_test::Trial;

struct ControlTestOptions {
  fs::path rig;
  fs::path model;
  fs::path out;
  int domain_id = 0;
  std::uint64_t seed = 101;
  int repeats = 3;
  bool quick = false;
  bool json = false;
};

// A folder of ours that goes when we go.
class WorkFolder {
 public:
  explicit WorkFolder(const fs::path& wanted) {
    if (!wanted.empty()) {
      path_ = wanted;
      fs::create_directories(path_);
      return;
    }
    std::string pattern = (fs::temp_directory_path() / "sinew-control-test-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
      throw UsageError(pattern + ": a folder cannot be made there");
    }
    path_ = pattern;
    temporary_ = true;
  }
  ~WorkFolder() {
    std::error_code ignored;
    if (temporary_) fs::remove_all(path_, ignored);
  }
  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  bool temporary_ = false;
};

nlohmann::ordered_json ToJson(const std::vector<Outcome>& outcomes) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Outcome& outcome : outcomes) {
    const Trial& trial = outcome.trial;
    list.push_back({{"strategy", control_test::ArmName(trial.arm)},
                    {"pressure_bar", trial.pressure_bar},
                    {"load", control_test::LoadTitle(trial.load)},
                    {"cycles", trial.cycles},
                    {"seed", trial.seed},
                    {"mse_rad2", outcome.score.whole.mean_square_error_rad2},
                    {"from_rest_mse_rad2", outcome.score.from_rest_mse_rad2},
                    {"late_mse_rad2", outcome.score.late_mse_rad2},
                    {"max_error_rad", outcome.score.whole.max_error_rad},
                    {"rms_motor_torque_Nm", outcome.score.motor_torque_rms_Nm},
                    {"rms_current_A", outcome.score.whole.rms_current_A},
                    {"positive_work_J", outcome.score.positive_work_J},
                    {"saturated_share", outcome.score.saturated_share}});
  }
  return list;
}

void RunControlTest(const ControlTestOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const WorkFolder work(options.out);
  control_test::RunnerConfig config;
  config.rig = options.rig.empty() ? tools::ShippedRobotFile("rig") : options.rig;
  config.model =
      options.model.empty() ? config.rig / "surrogate_model_identified.yaml" : options.model;
  config.folder = work.path() / "runs";
  config.domain_id = options.domain_id;
  if (!fs::exists(config.rig / "control_test")) {
    throw UsageError("--rig " + config.rig.string() +
                     ": no folder control_test in it, expected robots/rig");
  }

  std::vector<std::uint64_t> seeds;
  const int repeats = options.quick ? 1 : options.repeats;
  seeds.reserve(static_cast<std::size_t>(repeats));
  for (int i = 0; i < repeats; ++i) {
    seeds.push_back(options.seed + static_cast<std::uint64_t>(i));
  }
  const std::vector<Trial> first = control_test::BenchmarkTrials(seeds);
  const std::vector<Trial> second =
      options.quick ? control_test::GridTrials({4.0}, {Load::kChanging},
                                               {Arm::kNetwork, Arm::kAdapted}, options.seed)
                    : control_test::GridTrials(
                          {2.0, 4.0, 6.0}, {Load::kNone, Load::kExternal, Load::kChanging},
                          {Arm::kPid, Arm::kNetwork, Arm::kAdapted, Arm::kInverse}, options.seed);
  tools::ProgressBar bar("control-test", "runs", first.size() + second.size());
  control_test::Runner runner(config);
  std::uint64_t done = 0;
  const auto run = [&](const std::vector<Trial>& trials) {
    std::vector<Outcome> outcomes;
    for (const Trial& trial : trials) {
      outcomes.push_back(runner.Run(trial));
      bar.Update(++done);
    }
    return outcomes;
  };
  const std::vector<Outcome> benchmark = run(first);
  const std::vector<Outcome> grid = run(second);
  bar.Finish();

  report::Section section = control_test::MakeSection(benchmark, grid);
  section.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!options.out.empty()) report::WriteSection(options.out, section);
  if (options.json) {
    const nlohmann::ordered_json all = {{"benchmark", ToJson(benchmark)}, {"grid", ToJson(grid)}};
    std::cout << types::JsonText(all, 2) << '\n';
  } else {
    tools::PrintSection(section);
    if (!options.out.empty()) {
      std::printf("\n%s written, %.0f s\n", (options.out / "section.json").c_str(),
                  section.seconds);
    }
  }
}

}  // namespace

void AddControlTestCommand(CLI::App& app) {
  auto options = std::make_shared<ControlTestOptions>();
  CLI::App* command = app.add_subcommand(
      "control-test",
      "Compare control strategies as in Figs 7.2 and 7.3, over DDS on the surrogate");
  command
      ->add_option("--rig", options->rig,
                   "Folder of the rig's files; default: robots/rig that comes with the program")
      ->check(CLI::ExistingDirectory);
  command
      ->add_option("--model", options->model,
                   "Model with identified parameters for (7.1); default: "
                   "surrogate_model_identified.yaml of the rig")
      ->check(CLI::ExistingFile);
  command->add_option("--out", options->out,
                      "Folder for recordings and the section of a page; runs that are there "
                      "already are not made again");
  command->add_option("--domain", options->domain_id, "DDS domain, 0 to 232")
      ->check(CLI::Range(0, 232))
      ->envname("SINEW_DOMAIN")
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the first run")->capture_default_str();
  command->add_option("--repeats", options->repeats, "Seeds of the published test")
      ->check(CLI::Range(1, 100))
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "One seed and one load: about half a minute");
  command->add_flag("--json", options->json, "Scores of all runs as JSON");
  command->footer(
      "Examples:\n"
      "  sinew control-test --out results/control\n"
      "  sinew control-test --quick --json");
  command->callback([options] { RunControlTest(*options); });
}

}  // namespace sinew::reproduction

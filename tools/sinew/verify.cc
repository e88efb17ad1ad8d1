#include "tools/verify/verify.h"

#include <CLI/CLI.hpp>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>

#include "components/base/types/joined.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/report/file/section_file.h"
#include "components/record/recording/file/run_reader.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/print_section.h"
#include "tools/sinew/progress.h"
#include "tools/sinew/recordings.h"
#include "tools/sinew/shipped.h"

namespace sinew::tools {
namespace {

namespace fs = std::filesystem;

struct VerifyOptions {
  fs::path model, before, map, out, control, reference;
  std::vector<std::string> recordings, effects;
  double horizon_s = 0.5;
  double seconds = 13.0;
  double pressure_bar = 4.0;
  int seeds = 5;
  std::uint64_t seed = 1;
  bool tracking = false;
  bool json = false;
  bool strict = false;
};

struct BothModels {
  actuator::ModelFile before, after;
  fs::path before_path;  // empty: the same file without its added terms
};

BothModels LoadBoth(const VerifyOptions& options) {
  BothModels models;
  models.after = actuator::LoadModelFile(options.model);
  models.before_path = options.before;
  if (options.before.empty()) {
    models.before = models.after;
    models.before.robot = verify::WithoutAdded(models.after.robot);
  } else {
    models.before = actuator::LoadModelFile(options.before);
  }
  return models;
}

free_run::FreeRunResult Follow(const VerifyOptions& options, const BothModels& models) {
  const fs::path map = options.map.empty() ? DefaultCsvMap(options.model) : options.map;
  std::vector<types::Run> runs;
  for (const std::string& file : options.recordings) {
    std::vector<types::Run> some = recording::ReadRuns(file, map);
    if (some.empty()) throw UsageError(file + ": no run of joint 0, expected joint_state");
    for (types::Run& run : some) runs.push_back(std::move(run));
  }
  try {
    const identify::ProcessingOptions processing = identify::Resolve(
        identify::ReadProcessing(models.after.root, models.after.robot.joints.at(0).kind), runs);
    free_run::FreeRunResult result = verify::FollowRecordings(
        runs, models.before.robot, models.after.robot, processing, options.horizon_s);
    if (!result.errors) throw UsageError(options.model.string() + ": " + result.why_not);
    return result;
  } catch (const std::invalid_argument& error) {
    throw UsageError(options.recordings.front() + " with " + options.model.string() + ": " +
                     error.what());
  }
}

std::vector<verify::TrackingRun> TrackAll(const VerifyOptions& options, const BothModels& models) {
  const fs::path control =
      options.control.empty() ? ShippedRobotFile("rig/control_pid_model.yaml") : options.control;
  const fs::path reference = options.reference.empty()
                                 ? ShippedRobotFile("rig/reference_benchmark.yaml")
                                 : options.reference;
  verify::TrackingSetup setup;
  setup.rig.effects = surrogate::ParseEffects(options.effects);
  setup.rig.pneumatics.initial_pressure_bar = options.pressure_bar;
  setup.after.control = control::LoadControl(control, options.model).joints;
  setup.after.reference = reference::LoadReference(reference).config;
  setup.after.pneumatics =
      pneumatics::LoadPneumatics(ShippedRobotFile("rig/pneumatics.yaml")).joints;
  for (auto& joint : setup.after.pneumatics) joint.target_bar = options.pressure_bar;
  setup.after.duration_s = options.seconds;
  setup.after.score_from_s =
      setup.after.reference.start_delay_s + setup.after.reference.joints.at(0).soft_start_s;
  setup.before = setup.after;
  if (!models.before_path.empty()) {
    setup.before.control = control::LoadControl(control, models.before_path).joints;
  } else {
    for (std::size_t j = 0; j < setup.before.control.size(); ++j) {
      if (setup.before.control[j].model) {
        setup.before.control[j].model = models.before.robot.joints.at(j);
      }
    }
  }
  if (setup.after.control.size() != 1 || !setup.after.control[0].model ||
      setup.after.control[0].compensator.kind != control::CompensatorKind::kModel) {
    throw UsageError(control.string() +
                     ": expected one joint with strategy pid_linear and compensate: model, which "
                     "feeds the model forward");
  }
  std::vector<verify::TrackingRun> runs;
  ProgressBar bar("verify", "runs", static_cast<std::uint64_t>(options.seeds));
  for (int i = 0; i < options.seeds; ++i) {
    runs.push_back(verify::Track(setup, options.seed + static_cast<std::uint64_t>(i)));
    bar.Update(static_cast<std::uint64_t>(i) + 1);
  }
  return runs;
}

void RunVerify(const VerifyOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  if (options.recordings.empty() && !options.tracking) {
    throw UsageError("nothing to verify with, expected a recording or --tracking or both");
  }
  if (!options.effects.empty() && !options.tracking) {
    throw UsageError("--effect is of the surrogate in --tracking, which was not asked for");
  }
  const BothModels models = LoadBoth(options);
  verify::Names names;
  names.after = options.model.filename().string();
  names.before = options.before.empty() ? names.after + " without what was added to it"
                                        : options.before.filename().string();
  for (const actuator::Term& term : models.after.robot.joints.at(0).terms) {
    if (!term.declared) names.added.push_back(term.effect->info().name);
  }
  names.effects = options.effects.empty() ? "none" : types::Joined(options.effects);
  std::optional<free_run::FreeRunResult> following;
  if (!options.recordings.empty()) following = Follow(options, models);
  std::vector<verify::TrackingRun> tracking;
  if (options.tracking) tracking = TrackAll(options, models);

  const types::JointKind kind = models.after.robot.joints.at(0).kind;
  const free_run::FreeRunResult* found = following ? &*following : nullptr;
  report::Section section = verify::MakeSection(names, kind, found, tracking);
  section.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::string json = verify::FormatJson(names, kind, found, tracking);
  if (!options.out.empty()) {
    report::WriteSection(options.out, section);
    config::WriteFileAtomically(options.out / "verify.json", json);
  }
  if (options.json) {
    std::cout << json;
  } else {
    PrintSection(section);
  }
  if (options.strict && !AllMet(section)) throw CLI::RuntimeError(1);
}

}  // namespace

void AddVerifyCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "verify", "A corrected model in world and control: errors before and after");
  const auto options = std::make_shared<VerifyOptions>();
  command->add_option("--model", options->model, "Corrected model, e.g. found/model.yaml")
      ->required()
      ->check(CLI::ExistingFile);
  command
      ->add_option("--before", options->before,
                   "Model before; default: the corrected one without its added effects")
      ->check(CLI::ExistingFile);
  AddRecordings(*command, "--recording", &options->recordings,
                "CSV or MCAP: the world is moved as these were, and compared");
  command->add_option("--map", options->map, "Mapping of CSV columns")->check(CLI::ExistingFile);
  command->add_option("--horizon", options->horizon_s, "Length of a simulated piece, s")
      ->check(CLI::Range(0.02, 100.0))
      ->capture_default_str();
  command->add_flag("--tracking", options->tracking,
                    "The surrogate under PID with the model fed forward");
  command
      ->add_option("--effect", options->effects,
                   "Undeclared effect of that surrogate: NAME, NAME=SIZE; may be repeated")
      ->type_name("EFFECT");
  command
      ->add_option("--control", options->control, "Controller, sinew-control/1; default: the rig's")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--reference", options->reference,
                   "Reference, sinew-reference/1; default: the published control test")
      ->check(CLI::ExistingFile);
  command->add_option("--seconds", options->seconds, "Length of a run with --tracking")
      ->check(CLI::Range(5.0, 3600.0))
      ->capture_default_str();
  command->add_option("--pressure", options->pressure_bar, "Pressure with --tracking, bar")
      ->check(CLI::Range(0.5, 6.0))
      ->capture_default_str();
  command->add_option("--seeds", options->seeds, "Runs with --tracking")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the first")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--out", options->out, "Folder for verify.json and the section of a page");
  command->add_flag("--json", options->json, "As JSON");
  command->add_flag("--strict", options->strict, "Exit code 1 when an error did not fall");
  command->footer(
      "Examples:\n"
      "  sinew verify held_out.mcap --model found/model.yaml \\\n"
      "    --before robots/rig/surrogate_model.yaml --out found/verify\n"
      "  sinew verify --model found/model.yaml --tracking --effect stribeck");
  command->callback([options] { RunVerify(*options); });
}

}  // namespace sinew::tools

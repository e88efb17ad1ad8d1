#include "tools/sinew/experiment.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/model/actuator/file/model_file.h"
#include "components/model/experiment/catalogue.h"
#include "components/model/experiment/model_update.h"
#include "components/model/experiment/result.h"
#include "components/model/experiment/rows.h"
#include "components/model/report/file/section_file.h"
#include "components/topics/node/time_option.h"
#include "tools/sinew/experiment_run.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {
namespace {

namespace fs = std::filesystem;
using experiment::Quantity;
using nlohmann::ordered_json;

report::Section SectionOf(const ExperimentOutcome& done) {
  report::Section section = experiment::MakeSection(done.result);
  section.seconds = done.seconds;
  section.paragraphs.push_back("Data: " + done.source + ".");
  section.comparisons.insert(section.comparisons.end(), done.addition.comparisons.begin(),
                             done.addition.comparisons.end());
  section.tables.insert(section.tables.end(), done.addition.tables.begin(),
                        done.addition.tables.end());
  return section;
}

// The outcome of an experiment on the standard output, as JSON, and as files.
void PrintOutcome(const ExperimentOutcome& done) {
  Print("%s\n", done.result.title.c_str());
  Print("  %-42s %12s %-27s %-10s %-10s\n", "", "value", "95 % interval", "published", "true");
  for (const Quantity& q : done.result.quantities) {
    const std::string label = q.name + (q.unit.empty() ? "" : ", " + q.unit);
    const auto met = q.has_interval ? q.Met() : std::nullopt;
    Print("  %-42s %12s %-27s %-10s %-10s %s\n", label.c_str(),
          experiment::FormatValue(q.estimate.value).c_str(), experiment::FormatInterval(q).c_str(),
          q.published ? experiment::FormatValue(*q.published).c_str() : "-",
          q.truth ? experiment::FormatValue(*q.truth).c_str() : "-",
          met ? (*met ? (experiment::FormatTarget(q) + ": met").c_str()
                      : (experiment::FormatTarget(q) + ": MISSED").c_str())
              : "");
  }
  for (const std::string& remark : done.result.remarks) Print("  %s\n", remark.c_str());
  for (const std::string& line : done.addition.lines) Print("  %s\n", line.c_str());
  for (const std::string& change : done.changes) Print("  model: %s\n", change.c_str());
  if (!done.ending.empty() && done.ending != "done") Print("  ended: %s\n", done.ending.c_str());
}

ordered_json ToJson(const ExperimentOutcome& done) {
  ordered_json quantities = ordered_json::array();
  for (const Quantity& q : done.result.quantities) {
    ordered_json entry = {
        {"id", q.id}, {"name", q.name}, {"unit", q.unit}, {"value", q.estimate.value}};
    entry["half_width_95"] =
        q.has_interval ? ordered_json(q.estimate.half_width_95) : ordered_json(nullptr);
    entry["trials"] = q.estimate.trials;
    entry["published"] = q.published ? ordered_json(*q.published) : ordered_json(nullptr);
    entry["true"] = q.truth ? ordered_json(*q.truth) : ordered_json(nullptr);
    if (const auto met = q.Met()) entry["target_met"] = *met;
    quantities.push_back(std::move(entry));
  }
  ordered_json json = {{"experiment", done.result.experiment},
                       {"source", done.source},
                       {"quantities", quantities},
                       {"simulated_s", done.simulated_s},
                       {"time_s", done.seconds}};
  if (!done.addition.json.is_null()) json.update(done.addition.json);
  if (!done.ending.empty()) json["end"] = done.ending;
  if (!done.changes.empty()) json["model_changes"] = done.changes;
  return json;
}

// section.json with its pictures, data.csv, result.json. Throws UsageError.
void WriteFiles(const ExperimentOutcome& done, const fs::path& folder) {
  report::WriteSection(folder, SectionOf(done));
  config::WriteFileAtomically(folder / "data.csv", experiment::FormatCsv(done.rows));
  config::WriteFileAtomically(folder / "result.json", types::JsonText(ToJson(done), 2) + "\n");
}

void RunAll(const ExperimentOptions& given, const ExperimentSimulation* simulation) {
  ExperimentOptions options = given;
  if (std::find(options.names.begin(), options.names.end(), "all") != options.names.end()) {
    options.names = experiment::ExperimentNames();
  }
  if (!options.update_model.empty() && options.model.empty()) {
    throw UsageError("--update-model: needs --model, the file that the changes begin from");
  }
  if (options.topics && !options.recording.empty()) {
    throw UsageError("the recording is identified as it is, not with --dds");
  }
  if (options.topics && options.names.size() > 1) {
    throw UsageError("--dds: one experiment at a time, expected one NAME");
  }
  std::optional<actuator::ModelFile> file;
  actuator::JointModel model;
  model.constants.gear_ratio = 100.0;
  model.backlash_rad = 0.0464258;
  experiment::RigConstants constants;
  if (!options.model.empty()) {
    file = actuator::LoadModelFile(options.model);
    if (options.joint >= static_cast<int>(file->robot.joints.size())) {
      throw UsageError(options.model.string() + ": key 'joints': has " +
                       std::to_string(file->robot.joints.size()) + " joints, expected joint " +
                       std::to_string(options.joint) + " of --joint");
    }
    model = file->robot.joints[static_cast<std::size_t>(options.joint)];
    constants = ConstantsOf(model);
  }
  if (options.in_process() && simulation == nullptr) {
    throw UsageError(
        "experiment: neither --dds nor a recording; on the surrogate in this process it runs in a "
        "build with -DSINEW_BUILD_REPRODUCTION=ON");
  }
  const std::unique_ptr<SimulatedRig> rig =
      simulation != nullptr ? simulation->MakeRig(options) : nullptr;
  std::optional<node::StopFlag> stop;
  if (options.topics) stop.emplace();
  ordered_json all = ordered_json::array();
  bool first = true;
  for (const std::string& name : options.names) {
    const auto start = std::chrono::steady_clock::now();
    ExperimentOutcome done;
    try {
      done = options.topics                ? RunOverTopics(name, model, constants, *stop, options)
             : rig && options.in_process() ? rig->Run(name, constants)
                                           : RunFromRecording(name, constants, options);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
    if (rig && !options.in_process()) rig->FillTruth(&done.result);
    done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (file && !options.update_model.empty()) {
      done.changes =
          experiment::UpdateModel(done.result, done.source, types::UtcNow(),
                                  &file->robot.joints[static_cast<std::size_t>(options.joint)]);
    }
    if (!options.out.empty()) {
      WriteFiles(done, given.names.size() == 1 && options.names.size() > 1 ? options.out / name
                       : options.names.size() > 1                          ? options.out / name
                                                                           : options.out);
    }
    if (options.json) {
      all.push_back(ToJson(done));
    } else {
      if (!first) Print("\n");
      PrintOutcome(done);
      std::cout << std::flush;
    }
    first = false;
  }
  if (file && !options.update_model.empty()) actuator::SaveModelFile(options.update_model, *file);
  if (options.json) {
    std::cout << types::JsonText((all.size() == 1 ? all[0] : all), 2) << '\n';
  } else {
    if (!options.out.empty()) Print("%s written\n", options.out.c_str());
    if (!options.update_model.empty()) Print("%s written\n", options.update_model.c_str());
  }
}

}  // namespace

void AddExperimentCommand(CLI::App& app, const std::shared_ptr<ExperimentSimulation>& simulation) {
  CLI::App* command = app.add_subcommand(
      "experiment", "An experiment of the rig: run it, identify, compare with the published value");
  auto options = std::make_shared<ExperimentOptions>();
  std::vector<std::string> names = experiment::ExperimentNames();
  names.emplace_back("all");
  const auto is_name = [names](const std::string& word) {
    return std::find(names.begin(), names.end(), word) != names.end();
  };
  const auto check = [names, is_name](const std::string& word) {
    return is_name(word) || IsRecording(word)
               ? std::string()
               : "'" + word + "', expected a recording or one of: " + types::Joined(names);
  };
  command
      ->add_option("name", options->names,
                   "Experiments, or all; a recording (MCAP, or CSV with --map) to identify from "
                   "instead of running")
      ->required()
      ->check(CLI::Validator(check, "{" + types::Joined(names, ",") + "} FILE"));
  auto recordings = std::make_shared<std::vector<fs::path>>();
  AddReplaced(*command, "--recording", recordings.get());
  command
      ->add_option("--trials", options->trials,
                   "backlash: periods; breakaway: at each angle; pea-data: cycles")
      ->check(CLI::Range(1, 100000));
  command->add_option("--seed", options->seed, "Of noise, persons and specimens")
      ->capture_default_str();
  command->add_flag("--quick", options->quick, "Fewer trials: a look, not a measurement");
  command->add_option("--model", options->model, "Model file: constants of the rig")
      ->type_name("FILE.yaml");
  command
      ->add_option("--update-model", options->update_model,
                   "Model file to write: --model with the identified values and a line of "
                   "history")
      ->type_name("FILE.yaml");
  command
      ->add_option("--out", options->out,
                   "Folder for data.csv, result.json, section.json and pictures")
      ->type_name("DIR");
  command->add_flag("--json", options->json, "Result as JSON");
  command->add_option("--map", options->map, "Mapping file of a CSV recording");
  command
      ->add_option("--from", options->from_s, "Seconds of the recording to leave out at its start")
      ->check(node::IsTime(node::Zero::kAllowed));
  command->add_flag("--dds", options->topics,
                    "Run one repetition over topics, on whatever state provider is there");
  AddNodeOptions(*command, &options->node);
  command->add_option("--joint", options->joint, "Index of the joint")->check(CLI::Range(0, 11));
  command->add_flag("--arm", options->arm, "With --dds: arm the robot, and disarm it at the end");
  command->add_option("--record", options->record,
                      "With --dds: MCAP file to record; identification then reads it");
  command->add_option("--rest", options->rest_s, "With --dds: rest at each angle of breakaway, s")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->footer(
      "On a robot a person pushes the link as instructed; in a simulation the command pushes it\n"
      "(sim_disturbance). motor needs the motor uncoupled from the link.\n\nExamples:\n"
      "  sinew experiment backlash\n"
      "  sinew experiment motor run.mcap\n"
      "  sinew experiment all --seeds 100 --out results --model robots/rig/model.yaml \\\n"
      "    --update-model results/model.yaml\n"
      "  sinew-surrogate --domain 3 --lockstep --await joint_command,valve_command,sim_disturbance "
      "&\n"
      "  sinew experiment backlash --quick --dds --domain 3 --lockstep --arm");
  if (simulation != nullptr) simulation->AddOptions(*command);
  command->callback([options, simulation, recordings, is_name] {
    TakeRecordings(is_name, &options->names, recordings.get());
    if (options->names.empty()) throw CLI::RequiredError("name of an experiment");
    options->recording = OnlyOne(*recordings);
    RunAll(*options, simulation.get());
  });
}

}  // namespace sinew::tools

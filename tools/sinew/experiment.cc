#include "tools/sinew/experiment.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "components/actuator/file/model_file.h"
#include "components/config/config.h"
#include "components/experiment/catalogue.h"
#include "components/experiment/model_update.h"
#include "components/experiment/page.h"
#include "components/experiment/participant/over_topics.h"
#include "components/experiment/rows.h"
#include "components/logger/participant/record.h"
#include "components/recording/file/run_reader.h"
#include "components/report/file/section_file.h"
#include "components/types/clock/utc.h"
#include "sim/laboratory/coverage.h"
#include "sim/laboratory/laboratory.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "tools/sinew/node_options.h"
#include "tools/sinew/progress.h"

namespace sinew::tools {
namespace {

namespace fs = std::filesystem;
using experiment::Quantity;
using experiment::Recording;
using experiment::Result;
using nlohmann::ordered_json;

constexpr std::uint64_t kSteps = 1000;  // of a progress bar
constexpr double kLowestCoverage = 0.90, kHighestCoverage = 0.99;

struct Options {
  std::vector<std::string> names;
  fs::path surrogate, model, update_model, out, recording, map, record;
  int joint = 0;
  int trials = 0;
  int seeds = 0;
  int threads = 2;
  double spread = 0.1;
  double from_s = 0.0;
  double rest_s = 40.0;
  std::uint64_t seed = 1;
  bool quick = false;
  bool json = false;
  bool topics = false;
  bool arm = false;
  node::Options node;
};

struct Done {
  Result result;
  Recording rows;      // to be written as CSV
  std::string source;  // of the data, for the model's history
  std::string ending;  // over topics: why it ended
  std::map<std::string, laboratory::Coverage> coverage;
  std::vector<std::string> changes;  // of the model
  double simulated_s = 0.0;
  double seconds = 0.0;
};

experiment::RigConstants ConstantsOf(const actuator::JointModel& model) {
  experiment::RigConstants rig;
  rig.gear_ratio = model.constants.gear_ratio;
  rig.link_length_m = model.constants.link_length_m;
  rig.torque_constant_Nm_A = model.constants.torque_constant_Nm_A;
  if (model.Find("drive_current") >= 0) {
    rig.efficiency = model.Parameter("drive_current", "efficiency");
  }
  if (model.Find("gravity") >= 0) {
    rig.gravity_torque_Nm = model.Parameter("gravity", "gravity_torque");
  }
  return rig;
}

// A share of the work into a progress bar, from several threads.
class SharedProgress {
 public:
  explicit SharedProgress(const std::string& what)
      : bar_("experiment " + what, "permille", kSteps) {}
  void Print(double share) {
    const std::lock_guard<std::mutex> lock(mutex_);
    bar_.Update(static_cast<std::uint64_t>(std::clamp(share, 0.0, 1.0) * kSteps));
  }

 private:
  std::mutex mutex_;
  ProgressBar bar_;
};

// Seeds 1..n, each another specimen, by several threads. The order of what is counted does not
// depend on the threads.
std::map<std::string, laboratory::Coverage> CountCoverage(const std::string& name,
                                                          const surrogate::RigParameters& rig,
                                                          const experiment::RigConstants& constants,
                                                          const Options& options) {
  std::vector<std::optional<Result>> results(static_cast<std::size_t>(options.seeds));
  std::vector<std::exception_ptr> errors(results.size());
  std::atomic<std::size_t> next{0}, finished{0};
  SharedProgress progress(name + ", " + std::to_string(options.seeds) + " seeds");
  const auto work = [&] {
    for (std::size_t i = next++; i < results.size(); i = next++) {
      try {
        const std::uint64_t seed = options.seed + i;
        const surrogate::RigParameters specimen =
            laboratory::MakeSpecimen(rig, options.spread, seed);
        laboratory::Plan plan{
            .size = laboratory::Size::kCoverage, .constants = constants, .seed = seed + 1000003};
        results[i] = laboratory::RunOnSurrogate(name, specimen, plan).result;
      } catch (...) {
        errors[i] = std::current_exception();
      }
      progress.Print(static_cast<double>(++finished) / static_cast<double>(results.size()));
    }
  };
  std::vector<std::thread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  for (std::thread& thread : threads) thread.join();
  laboratory::CoverageCount count;
  for (std::size_t i = 0; i < results.size(); ++i) {
    if (errors[i]) std::rethrow_exception(errors[i]);
    count.Add(*results[i]);
  }
  return count.by_id();
}

Done RunInProcess(const std::string& name, const surrogate::RigParameters& rig,
                  const experiment::RigConstants& constants, const Options& options) {
  Done done;
  laboratory::Plan plan;
  plan.size = options.quick ? laboratory::Size::kQuick : laboratory::Size::kFull;
  plan.trials = options.trials;
  plan.constants = constants;
  plan.seed = options.seed;
  {
    SharedProgress progress(name);
    laboratory::Outcome outcome = laboratory::RunOnSurrogate(
        name, rig, plan, [&progress](double share) { progress.Print(share); });
    done.result = std::move(outcome.result);
    done.simulated_s = outcome.simulated_s;
    // Trials of their own stand one after the other, a second apart.
    double offset_s = 0.0;
    for (const Recording& recording : outcome.recordings) {
      for (experiment::Row row : recording) {
        row.time_s += offset_s;
        done.rows.push_back(row);
      }
      if (!done.rows.empty()) offset_s = done.rows.back().time_s + 1.0;
    }
  }
  done.source = "surrogate, seed " + std::to_string(options.seed);
  const bool data_only = name == "sea-data" || name == "pea-data";
  if (options.seeds > 0 && !data_only) {
    done.coverage = CountCoverage(name, rig, constants, options);
  }
  return done;
}

Done RunFromRecording(const std::string& name, const experiment::RigConstants& constants,
                      const Options& options) {
  const bool csv = options.recording.extension() != ".mcap";
  if (csv && options.map.empty()) {
    throw UsageError("--map: missing, expected the mapping file of " + options.recording.string() +
                     " (robots/rig/experiment_map.yaml for data.csv of this command)");
  }
  const std::vector<types::Run> runs = recording::ReadRuns(
      options.recording, csv ? options.map : fs::path(), csv ? 0 : options.joint);
  if (runs.empty()) throw UsageError(options.recording.string() + ": no rows");
  Done done;
  const types::Run& run = runs.back();
  done.rows = experiment::RowsOfRun(run, run.time_s(0) + options.from_s);
  done.result = experiment::Identify(name, done.rows, constants);
  done.source = options.recording.filename().string();
  return done;
}

Done RunOverTopics(const std::string& name, const actuator::JointModel& model,
                   const experiment::RigConstants& constants, node::StopFlag& stop,
                   const Options& options) {
  Done done;
  experiment::Prepared protocol(experiment::MakeProtocol(name, {.trials = options.trials,
                                                                .quick = options.quick,
                                                                .rest_s = options.rest_s,
                                                                .play_rad = model.backlash_rad,
                                                                .gear_ratio = constants.gear_ratio,
                                                                .seed = options.seed}),
                                constants.gear_ratio);
  node::Node node(options.node);
  // The recorder is a participant of its own: it hears what everybody hears.
  std::optional<node::Node> recorder_node;
  std::thread recorder;
  std::exception_ptr recorder_error;
  if (!options.record.empty()) {
    node::Options recorder_options = options.node;
    recorder_options.name = recorder_options.component = "experiment_recorder";
    recorder_node.emplace(recorder_options);
    recorder = std::thread([&] {
      try {
        logger::RecordOptions record;
        record.out = options.record;
        record.overwrite = true;
        record.notes = {"experiment=" + name};
        (void)logger::Record(*recorder_node, stop, record);
      } catch (...) {
        recorder_error = std::current_exception();
      }
    });
  }
  experiment::TopicRun run;
  std::exception_ptr run_error;
  try {
    ProgressBar bar("experiment " + name, "s", static_cast<std::uint64_t>(protocol.expected_s()));
    std::string printed;
    run = experiment::RunOverTopics(node, stop, protocol,
                                    {.joint = options.joint, .arm = options.arm},
                                    [&](const experiment::TopicProgress& now) {
                                      bar.Update(static_cast<std::uint64_t>(now.time_s));
                                      if (now.instruction != printed && !options.json) {
                                        printed = now.instruction;
                                        if (!printed.empty())
                                          std::cerr << "person at the link: " << printed << '\n';
                                      }
                                    });
  } catch (...) {
    run_error = std::current_exception();
  }
  if (recorder.joinable()) {
    stop.Request();
    recorder.join();
  }
  if (run_error) std::rethrow_exception(run_error);
  if (recorder_error) std::rethrow_exception(recorder_error);
  done.ending = run.end;
  done.rows = std::move(run.rows);
  done.source = "topics";
  if (!options.record.empty()) {
    // What counts is what was recorded.
    const std::vector<types::Run> runs = recording::ReadRuns(options.record, {}, options.joint);
    if (!runs.empty()) done.rows = experiment::RowsOfRun(runs.back(), run.started_s);
    done.source = options.record.filename().string();
  }
  try {
    done.result = experiment::Identify(name, done.rows, constants);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(std::string(error.what()) + " (the run ended: " + run.end +
                             ", after " + std::to_string(done.rows.size()) + " rows)");
  }
  return done;
}

// ---- printing

void PrintResult(const Done& done) {
  std::printf("%s\n", done.result.title.c_str());
  std::printf("  %-42s %12s %-27s %-10s %-10s\n", "", "value", "95 % interval", "published",
              "true");
  for (const Quantity& q : done.result.quantities) {
    const std::string label = q.name + (q.unit.empty() ? "" : ", " + q.unit);
    const auto met = q.has_interval ? q.Met() : std::nullopt;
    std::printf("  %-42s %12s %-27s %-10s %-10s %s\n", label.c_str(),
                experiment::FormatEstimate(q).c_str(), experiment::FormatInterval(q).c_str(),
                q.published ? experiment::FormatValue(*q.published).c_str() : "-",
                q.truth ? experiment::FormatValue(*q.truth).c_str() : "-",
                met ? (*met ? (experiment::FormatTarget(q) + ": met").c_str()
                            : (experiment::FormatTarget(q) + ": MISSED").c_str())
                    : "");
  }
  for (const std::string& remark : done.result.remarks) std::printf("  %s\n", remark.c_str());
  for (const auto& [id, c] : done.coverage) {
    std::printf(
        "  %-34s intervals contain the true value in %d of %d seeds; bias %.2f %%, half width %.2f "
        "%%%s\n",
        id.c_str(), c.covered, c.seeds, 100.0 * c.mean_error, 100.0 * c.mean_half_width,
        c.has_target ? ("; target met in " + std::to_string(c.met)).c_str() : "");
  }
  for (const std::string& change : done.changes) std::printf("  model: %s\n", change.c_str());
  if (!done.ending.empty() && done.ending != "done")
    std::printf("  ended: %s\n", done.ending.c_str());
}

ordered_json ToJson(const Done& done) {
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
  if (!done.coverage.empty()) {
    ordered_json coverage = ordered_json::object();
    for (const auto& [id, c] : done.coverage) {
      coverage[id] = {{"seeds", c.seeds},
                      {"covered", c.covered},
                      {"target_met", c.has_target ? ordered_json(c.met) : ordered_json(nullptr)},
                      {"bias_1", c.mean_error},
                      {"largest_error_1", c.largest_error},
                      {"half_width_1", c.mean_half_width}};
    }
    json["coverage"] = coverage;
  }
  if (!done.ending.empty()) json["end"] = done.ending;
  if (!done.changes.empty()) json["model_changes"] = done.changes;
  return json;
}

std::string Percent(double share) {
  char text[24];
  std::snprintf(text, sizeof text, "%.2f %%", 100.0 * share);
  return text;
}

report::Section SectionOf(const Done& done, const Options& options) {
  report::Section section = experiment::MakeSection(done.result);
  section.seconds = done.seconds;
  section.paragraphs.push_back("Data: " + done.source + ".");
  if (done.coverage.empty()) return section;
  report::Table table;
  table.title = "Intervals against the truth of many specimens";
  table.caption = "Each seed is another specimen whose parameters are off by up to " +
                  Percent(options.spread) + ".";
  table.header = {"quantity",     "seeds", "intervals that held the truth",
                  "targets met",  "bias",  "half width",
                  "largest error"};
  for (const auto& [id, c] : done.coverage) {
    const Quantity* quantity = done.result.Find(id);
    table.rows.push_back(
        {quantity != nullptr ? quantity->name : id, std::to_string(c.seeds),
         std::to_string(c.covered), c.has_target ? std::to_string(c.met) : std::string("-"),
         Percent(c.mean_error), Percent(c.mean_half_width), Percent(c.largest_error)});
    if (!c.has_target) continue;
    report::Comparison line;
    line.name = (quantity != nullptr ? quantity->name : id) + ": coverage of its interval";
    line.unit = "%";
    char text[24];
    std::snprintf(text, sizeof text, "%.0f", 100.0 * c.share());
    line.ours = text;
    line.target = "90 to 99 % of the seeds";
    line.met = c.share() >= kLowestCoverage - 1e-9 && c.share() <= kHighestCoverage + 1e-9;
    line.remark = std::to_string(c.seeds) + " seeds";
    section.comparisons.push_back(std::move(line));
  }
  section.tables.push_back(std::move(table));
  return section;
}

void WriteFiles(const Done& done, const fs::path& folder, const Options& options) {
  report::WriteSection(folder, SectionOf(done, options));
  config::WriteFileAtomically(folder / "data.csv", experiment::FormatCsv(done.rows));
  config::WriteFileAtomically(folder / "result.json", ToJson(done).dump(2) + "\n");
}

void RunAll(const Options& given) {
  Options options = given;
  if (std::find(options.names.begin(), options.names.end(), "all") != options.names.end()) {
    options.names = experiment::ExperimentNames();
  }
  if (!options.update_model.empty() && options.model.empty()) {
    throw UsageError("--update-model: needs --model, the file that the changes begin from");
  }
  if (options.topics && !options.recording.empty()) {
    throw UsageError("--recording: is identified as it is, not with --dds");
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
  std::optional<surrogate::RigParameters> rig;
  const bool in_process = !options.topics && options.recording.empty();
  if (in_process || !options.surrogate.empty()) {
    rig = surrogate::LoadRig(options.surrogate);
    rig->seed = options.seed;
    rig = surrogate::Specimen(*rig);
  }
  std::optional<node::StopFlag> stop;
  if (options.topics) {
    stop.emplace();
    StartCommandLog("experiment");
  }
  ordered_json all = ordered_json::array();
  bool first = true;
  for (const std::string& name : options.names) {
    const auto start = std::chrono::steady_clock::now();
    Done done;
    try {
      done = options.topics ? RunOverTopics(name, model, constants, *stop, options)
             : in_process   ? RunInProcess(name, *rig, constants, options)
                            : RunFromRecording(name, constants, options);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
    if (rig && !in_process) laboratory::FillTruth(*rig, &done.result);
    done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (file && !options.update_model.empty()) {
      done.changes =
          experiment::UpdateModel(done.result, done.source, types::UtcNow(),
                                  &file->robot.joints[static_cast<std::size_t>(options.joint)]);
    }
    if (!options.out.empty()) {
      WriteFiles(done,
                 given.names.size() == 1 && options.names.size() > 1 ? options.out / name
                 : options.names.size() > 1                          ? options.out / name
                                                                     : options.out,
                 options);
    }
    if (options.json) {
      all.push_back(ToJson(done));
    } else {
      if (!first) std::printf("\n");
      PrintResult(done);
      std::fflush(stdout);
    }
    first = false;
  }
  if (file && !options.update_model.empty()) actuator::SaveModelFile(options.update_model, *file);
  if (options.json) {
    std::cout << (all.size() == 1 ? all[0] : all).dump(2) << '\n';
  } else {
    if (!options.out.empty()) std::printf("%s written\n", options.out.c_str());
    if (!options.update_model.empty()) std::printf("%s written\n", options.update_model.c_str());
  }
}

}  // namespace

void AddExperimentCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "experiment", "An experiment of the rig: run it, identify, compare with the published value");
  auto options = std::make_shared<Options>();
  std::vector<std::string> names = experiment::ExperimentNames();
  names.emplace_back("all");
  command->add_option("name", options->names, "Experiments, or all")
      ->required()
      ->check(CLI::IsMember(names));
  command->add_option("--surrogate", options->surrogate,
                      "File (sinew-surrogate/1) of the rig that is played; with --dds or "
                      "--recording only the true values are taken from it");
  command
      ->add_option("--trials", options->trials,
                   "backlash: periods; breakaway: at each angle; pea-data: cycles")
      ->check(CLI::Range(1, 100000));
  command
      ->add_option("--seeds", options->seeds,
                   "In process: also count over this many specimens how often intervals contain "
                   "the truth")
      ->check(CLI::Range(1, 10000));
  command
      ->add_option("--spread", options->spread, "Specimens of --seeds are off by up to this share")
      ->check(CLI::Range(0.0, 0.3))
      ->capture_default_str();
  command->add_option("--threads", options->threads, "For --seeds")
      ->check(CLI::Range(1, 64))
      ->capture_default_str();
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
  command->add_option("--recording", options->recording,
                      "Identify from this recording (MCAP, or CSV with --map) instead of running");
  command->add_option("--map", options->map, "Mapping file of a CSV recording");
  command
      ->add_option("--from", options->from_s, "Seconds of the recording to leave out at its start")
      ->check(CLI::NonNegativeNumber);
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
      "  sinew experiment all --seeds 100 --out results --model robots/rig/model.yaml \\\n"
      "    --update-model results/model.yaml\n"
      "  sinew-surrogate --domain 3 --lockstep --await joint_command,valve_command,sim_disturbance "
      "&\n"
      "  sinew experiment backlash --quick --dds --domain 3 --lockstep --arm");
  command->callback([options] { RunAll(*options); });
}

}  // namespace sinew::tools

#include "tools/sinew/experiment_run.h"

#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <thread>

#include "components/base/config/config.h"
#include "components/model/experiment/catalogue.h"
#include "components/model/experiment/participant/over_topics.h"
#include "components/model/experiment/rows.h"
#include "components/record/logger/participant/record.h"
#include "components/record/recording/file/run_reader.h"
#include "tools/sinew/progress.h"

namespace sinew::tools {

namespace fs = std::filesystem;

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

ExperimentOutcome RunFromRecording(const std::string& name,
                                   const experiment::RigConstants& constants,
                                   const ExperimentOptions& options) {
  const bool csv = options.recording.extension() != ".mcap";
  if (csv && options.map.empty()) {
    throw UsageError("--map: missing, expected the mapping file of " + options.recording.string() +
                     " (robots/rig/experiment_map.yaml for data.csv of this command)");
  }
  const std::vector<types::Run> runs = recording::ReadRuns(
      options.recording, csv ? options.map : fs::path(), csv ? 0 : options.joint);
  if (runs.empty()) throw UsageError(options.recording.string() + ": no rows");
  ExperimentOutcome done;
  const types::Run& run = runs.back();
  done.rows = experiment::RowsOfRun(run, run.time_s(0) + options.from_s);
  done.result = experiment::Identify(name, done.rows, constants);
  done.source = options.recording.filename().string();
  return done;
}

ExperimentOutcome RunOverTopics(const std::string& name, const actuator::JointModel& model,
                                const experiment::RigConstants& constants, node::StopFlag& stop,
                                const ExperimentOptions& options) {
  ExperimentOutcome done;
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
    // The recorded rows count.
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

}  // namespace sinew::tools

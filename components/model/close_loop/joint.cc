#include <chrono>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/model/close_loop/builders.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/report/errors.h"
#include "components/model/shooting/close_by_simulation.h"

namespace sinew::close_loop {

namespace {

using Clock = std::chrono::steady_clock;

// Keys of `processing` that stand alone decide nothing.
void NoteProcessing(const config::Section& root, const identify::ProcessingOptions& wished,
                    report::Report* report) {
  if (!root.Has("processing") || wished.state_cutoff_Hz > 0.0) return;
  report->gate.findings.push_back(
      {"processing",
       "without state_cutoff_Hz the recordings decide how they are processed: of the model file's "
       "`processing` only longest_gap_s is used",
       0.0, ""});
}

// A recording with gaps or shorter than the published processing asks for has no such figures.
void ReproducePublished(const JointTask& task, const actuator::JointModel& joint,
                        const identify::AsPublishedOptions& published, report::Report* report) {
  try {
    report->as_published =
        identify::RunAsPublished(task.train.front(), task.held_out.front(), joint, published);
  } catch (const std::invalid_argument& error) {
    report->gate.findings.push_back(
        {"as_published", std::string("not processed as published: ") + error.what(), 0.0, ""});
  }
}

// Each recording beside the models of the rotation that held it out.
free_run::FreeRunResult FollowRotations(const std::vector<trace::Fold>& folds,
                                        const std::vector<trace::Rotation>& rotations,
                                        const free_run::MakeBody& body) {
  std::vector<free_run::FreeRunResult> parts;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    const trace::TraceResult& trace = rotations[i].trace;
    parts.push_back(free_run::Compare({folds[i].held_out},
                                      {trace.nominal, trace.declared, trace.corrected},
                                      rotations[i].processing, body));
  }
  return free_run::Join(std::move(parts));
}

// The joint as corrected, with its history and what was added now.
actuator::JointModel Corrected(const report::Report& report, const actuator::JointModel& declared) {
  const trace::TraceResult& trace = report.trace;
  actuator::JointModel joint = trace.corrected;
  joint.history = declared.history;
  const History now = {types::UtcNow(), report::NamesOf(report.train)};
  if (!report::HasCorrection(trace)) {
    now.Add("refit",
            "declared parameters refitted, no effect added; held-out error " +
                report::Short(trace.before_held_out.rms) + " " + report::ErrorUnit(trace),
            &joint);
  }
  for (const trace::FoundEffect& effect : trace.effects) {
    now.Add(effect.name,
            "held-out error " + report::ErrorText(effect.held_out_before) + " -> " +
                report::ErrorText(effect.held_out_after) + " " +
                report::ErrorUnit(trace, effect.balance) + " on " +
                report::NamesOf(report.held_out) + "; " + report::NamedSetText(effect.posterior),
            &joint);
  }
  return joint;
}

trace::TraceOptions TraceOptionsOf(const Options& options, const JointTask& task) {
  trace::TraceOptions out;
  out.in_force = options.in_force;
  out.seed = options.seed;
  out.agreed = options.given;
  out.keep_refuted = options.given.has_value();
  out.keep_unconfirmed = options.keep_unconfirmed || options.given;
  out.searches = task.searches;
  out.held_out_error = task.held_out_error;
  out.progress = [&task](const std::string&, double share) { task.progress(share); };
  return out;
}

// Fits and searches; then the models beside the recordings.
trace::LoopResult Close(const Options& options, const identify::ProcessingOptions& wished,
                        const actuator::JointModel& joint, JointTask* task,
                        report::Report* report) {
  trace::TraceOptions trace_options = TraceOptionsOf(options, *task);
  // That of an arm is for the common fit of its joints.
  const bool of_arm = joint.Find("rigid_body") >= 0;
  if (!of_arm && wished.state_cutoff_Hz > 0.0) trace_options.processing = wished;
  const bool rotates = task->held_out.empty();
  trace::LoopResult loop;
  if (options.by_simulation) {
    loop = shooting::CloseBySimulation(task->train, task->held_out, joint, wished.longest_gap_s,
                                       trace_options, options.body);
  } else if (rotates) {
    if (task->folds.empty()) task->folds = trace::LeaveOneOut(task->train, joint);
    trace::RotatedLoop rotated =
        trace::RotateLoop(task->folds, task->train, joint, wished.longest_gap_s, trace_options);
    loop = std::move(rotated.all);
    report->rotations = std::move(rotated.rotations);
  } else {
    loop =
        trace::CloseLoop(task->train, task->held_out, joint, wished.longest_gap_s, trace_options);
  }
  report->processing = loop.processing;
  report->trace = std::move(loop.trace);
  if (!report->assessed()) return loop;
  task->progress(0.97);
  const trace::TraceResult& trace = report->trace;
  report->free_run =
      rotates ? FollowRotations(task->folds, report->rotations, options.body)
              : free_run::Compare(task->held_out, {trace.nominal, trace.declared, trace.corrected},
                                  report->processing, options.body);
  return loop;
}

}  // namespace

void History::Add(const std::string& effect, const std::string& note,
                  actuator::JointModel* joint) const {
  joint->history.push_back({when, effect, from, note});
}

report::Page TraceJoint(const Options& options, const Input& input, JointTask task, Result* out) {
  const Clock::time_point start = Clock::now();
  const auto number = static_cast<std::size_t>(task.joint);
  const actuator::JointModel& joint = input.model.robot.joints[number];
  const identify::ProcessingOptions wished = identify::ReadProcessing(input.model.root, joint.kind);
  const auto published = identify::ReadAsPublished(input.model.root);
  const bool rotates = options.held_out.empty();
  if (task.train.empty() || (task.held_out.empty() && !rotates)) {
    throw UsageError("no recording of joint " + std::to_string(task.joint) +
                     ", expected at least one to train on and one held out");
  }
  if (rotates && options.by_simulation) {
    throw UsageError("--by simulation: nothing is held out, expected --held-out");
  }
  if (rotates) RequireRotation(options, task.train);
  trace::RequireHeldOut(task.train, task.held_out);
  const std::vector<types::Run> all = Together(task.train, task.held_out);
  // A mapping without the drive is a mistake of the command, no fault of the data.
  for (const types::Run& run : all) run.At(identify::DriveSignal(joint));
  task.progress(0.01);
  report::Report& report = out->joints.emplace_back();
  report.robot = input.model.robot.name;
  report.joint = joint.name;
  report.model_file = input.model_path.string();
  report.seed = options.seed;
  report.given = options.given;
  report.gate = task.gate ? *task.gate : AskGate(options, all, joint);
  const bool stops = report.gate.stops();
  if (!stops && !task.gate) LeaveOutRows(report.gate.left_out, &task.train, &task.held_out);
  report.train = Described(task.train);
  report.held_out = Described(rotates ? task.train : task.held_out);
  std::vector<report::Picture> pictures;
  if (stops) {
    pictures = report::MakePictures(report.gate, all, joint);
  } else {
    NoteProcessing(input.model.root, wished, &report);
    const trace::LoopResult loop = Close(options, wished, joint, &task, &report);
    const bool reproduces = published && !rotates && report.assessed();
    if (reproduces) ReproducePublished(task, joint, *published, &report);
    if (report.assessed()) pictures = report::MakePictures(report, *loop.train, *loop.held_out);
  }
  report.seconds = std::chrono::duration<double>(Clock::now() - start).count();
  if (report.assessed()) {
    out->assessed = true;
    out->model.robot.joints[number] = Corrected(report, joint);
  }
  return report::MakePage(report, std::move(pictures));
}

}  // namespace sinew::close_loop

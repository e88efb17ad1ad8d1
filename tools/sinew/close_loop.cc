#include "tools/sinew/close_loop.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/identify/interpolated.h"
#include "components/model/report/errors.h"
#include "components/model/report/file/report_file.h"
#include "components/model/shooting/close_by_simulation.h"
#include "components/model/trace/close_loop.h"
#include "components/record/recording/file/recording_path.h"
#include "components/record/recording/file/run_reader.h"
#include "sim/plant/joint_body.h"
#include "tools/sinew/shipped.h"

namespace sinew::tools {

namespace {

namespace fs = std::filesystem;

// Everything that follows the angle needs the angle.
void RequireAngle(const types::Run& run) {
  using types::Signal;
  if (run.Has(Signal::kPosition) || run.Has(Signal::kMotorPosition)) return;
  const bool velocity = run.Has(Signal::kVelocity) || run.Has(Signal::kMotorVelocity);
  throw UsageError(run.name +
                   (velocity
                        ? ": velocity without an angle: its integral drifts and has no zero, so "
                          "that gravity, springs and lines of the gear cannot be found"
                        : ": no angle") +
                   ", expected position or motor_position among the signals of the mapping");
}

}  // namespace

std::vector<types::Run> ReadJoint(const std::vector<fs::path>& files, const fs::path& map,
                                  int joint) {
  std::vector<types::Run> runs;
  for (const fs::path& file : files) {
    const bool csv = !recording::ParseRecordingPath(file).IsMcap();
    for (types::Run& run : recording::ReadRuns(file, csv ? map : fs::path(), joint)) {
      run.name = fs::path(run.name).filename().string();
      RequireAngle(run);
      runs.push_back(identify::WithoutInterpolatedRows(std::move(run)));
    }
  }
  return runs;
}

void RequireOtherRows(const std::vector<fs::path>& train, const std::vector<fs::path>& held_out) {
  for (const fs::path& a : held_out) {
    const recording::RecordingPath one = recording::ParseRecordingPath(a);
    for (const fs::path& b : train) {
      const recording::RecordingPath other = recording::ParseRecordingPath(b);
      std::error_code error;
      if (!one.range && !other.range) continue;  // whole files are compared by their samples
      if (!fs::equivalent(one.file, other.file, error) || error) continue;
      if (!one.range.value_or(recording::TimeRange{})
               .Overlaps(other.range.value_or(recording::TimeRange{}))) {
        continue;
      }
      throw UsageError(a.string() + ": held-out range shares rows with " + b.string() +
                       ", expected one that was not trained on");
    }
  }
}

std::vector<report::Recording> Describe(const std::vector<types::Run>& runs) {
  std::vector<report::Recording> out;
  out.reserve(runs.size());
  for (const types::Run& run : runs) {
    out.push_back(
        {run.name, run.content_hash, run.size(), run.time_s[run.size() - 1] - run.time_s[0]});
  }
  return out;
}

namespace {

// A laboratory's rig.json has no processing block: that of the shipped rig is used.
void CompleteRigJson(actuator::ModelFile* file, const fs::path& path) {
  if (path.extension() != ".json") return;
  actuator::ModelFile shipped = actuator::LoadModelFile(ShippedRobotFile("rig/model.yaml"));
  file->root = shipped.root;
  file->foreign_text = shipped.foreign_text;
  file->robot.urdf_path = shipped.robot.urdf_path;
}

void AddHistory(const report::Report& report, actuator::JointModel* joint) {
  const trace::TraceResult& trace = report.trace;
  const std::string when = types::UtcNow();
  const std::string from = report::NamesOf(report.train);
  const std::string unit = report::ErrorUnit(trace);
  if (!report::HasCorrection(trace)) {
    joint->history.push_back({when, "refit", from,
                              "declared parameters refitted, no effect added; held-out error " +
                                  report::Short(trace.before_held_out.rms) + " " + unit});
  }
  for (const trace::FoundEffect& effect : trace.effects) {
    std::string note = "held-out error " + report::ErrorText(effect.held_out_before) + " -> " +
                       report::ErrorText(effect.held_out_after) + " " +
                       report::ErrorUnit(trace, effect.balance) + " on " +
                       report::NamesOf(report.held_out);
    note += "; " + report::NamedSetText(effect);
    joint->history.push_back({when, effect.name, from, note});
  }
}

// One behind the other, as the data gate examines them.
std::vector<types::Run> Together(const std::vector<types::Run>& train,
                                 const std::vector<types::Run>& held_out) {
  std::vector<types::Run> runs = train;
  runs.insert(runs.end(), held_out.begin(), held_out.end());
  return runs;
}

// The data gate over all recordings; true: it stopped, and the result's pages contain the faults.
// Otherwise they go on without the rows that it left out.
bool StopsAtGate(const CloseLoopOptions& options, const actuator::JointModel& joint,
                 std::vector<types::Run>* train, std::vector<types::Run>* held_out,
                 CloseLoopResult* out) {
  const std::vector<types::Run> runs = Together(*train, *held_out);
  out->gate = options.gate ? *options.gate : AskGate(options, runs, joint);
  report::Report& report = out->report;
  report.faults = out->gate.faults;
  report.findings = out->gate.findings;
  if (!out->gate.stops()) {
    if (!options.gate) LeaveOutRows(out->gate.left_out, train, held_out);
    return false;
  }
  const report::DataCheck check{.robot = report.robot,
                                .joint = joint.name,
                                .model_file = report.model_file,
                                .train = report.train,
                                .held_out = report.held_out,
                                .gate = out->gate,
                                .seed = report.seed};
  const std::vector<report::Picture> pictures = report::MakePictures(out->gate, runs, joint);
  out->html = report::FormatHtml(check, pictures, report::DrawPictures(pictures));
  out->json = report::FormatDataFaultJson(check);
  return true;
}

// Keys of `processing` that stand alone decide nothing.
void NoteProcessing(const config::Section& root, const identify::ProcessingOptions& wished,
                    report::Report* report) {
  if (!root.Has("processing") || wished.state_cutoff_Hz > 0.0) return;
  report->findings.push_back(
      {"processing",
       "without state_cutoff_Hz the recordings decide how they are processed: of the model file's "
       "`processing` only longest_gap_s is used",
       0.0, ""});
}

// A recording with gaps or shorter than the published processing asks for has no such figures.
void ReproducePublished(const types::Run& train, const types::Run& held_out,
                        const actuator::JointModel& joint,
                        const identify::AsPublishedOptions& published, report::Report* report) {
  try {
    report->as_published = identify::RunAsPublished(train, held_out, joint, published);
  } catch (const std::invalid_argument& error) {
    report->findings.push_back(
        {"as_published", std::string("not processed as published: ") + error.what(), 0.0, ""});
  }
}

// Each recording beside the models of the rotation that held it out.
free_run::FreeRunResult FollowRotations(const std::vector<trace::Fold>& folds,
                                        const std::vector<trace::Rotation>& rotations) {
  std::vector<free_run::FreeRunResult> parts;
  for (std::size_t i = 0; i < folds.size(); ++i) {
    const trace::TraceResult& trace = rotations[i].trace;
    parts.push_back(free_run::Compare({folds[i].held_out},
                                      {trace.nominal, trace.declared, trace.corrected},
                                      rotations[i].processing, plant::JointAlone()));
  }
  return free_run::Join(std::move(parts));
}

}  // namespace

void RequireRotation(const CloseLoopOptions& options, const std::vector<types::Run>& runs) {
  if (runs.size() > 1) return;
  const std::string file = options.train.empty() ? runs.front().name : options.train[0].string();
  if (runs.front().held) {
    throw UsageError(file +
                     ": nothing is held out, expected --held-out or further recordings to train on "
                     "(each is held out once)");
  }
  const Eigen::VectorXd& time_s = runs.front().time_s;
  const std::string middle =
      report::Short(std::floor(0.7 * (time_s[time_s.size() - 1] - time_s[0])));
  const std::string whole = file.substr(0, file.find('@'));
  throw UsageError(
      "one recording and nothing held out, expected --held-out, further recordings to "
      "train on (each is held out once), or parts: --train " +
      whole + "@:" + middle + " --held-out " + whole + "@" + middle + ":");
}

LoopInput LoadLoopInput(const CloseLoopOptions& options) {
  LoopInput out;
  out.model_path = options.model.empty() ? ShippedRobotFile("rig/model.yaml") : options.model;
  out.map = options.map.empty() ? DefaultCsvMap(out.model_path) : options.map;
  out.held_out_map = options.held_out_map.empty() ? out.map : options.held_out_map;
  out.model = actuator::LoadModelFile(out.model_path);
  CompleteRigJson(&out.model, out.model_path);
  if (options.joint < 0 || options.joint >= static_cast<int>(out.model.robot.joints.size())) {
    throw UsageError("--joint " + std::to_string(options.joint) + ": model " +
                     out.model_path.string() + " has joints 0 to " +
                     std::to_string(out.model.robot.joints.size() - 1));
  }
  return out;
}

CloseLoopResult CloseLoopOn(const CloseLoopOptions& options, const LoopInput& input,
                            std::vector<types::Run> train, std::vector<types::Run> held_out) {
  const auto start = std::chrono::steady_clock::now();
  const auto progress = [&](const std::string& what, double share) {
    if (options.progress) options.progress(what, share);
  };
  const auto since_start = [start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  CloseLoopResult out;
  out.model = input.model;
  const fs::path& model_path = input.model_path;
  actuator::JointModel& joint = out.model.robot.joints[static_cast<std::size_t>(options.joint)];
  const identify::ProcessingOptions wished = identify::ReadProcessing(out.model.root, joint.kind);
  const std::optional<identify::AsPublishedOptions> published =
      identify::ReadAsPublished(out.model.root);
  const bool rotates = options.held_out.empty();
  if (train.empty() || (held_out.empty() && !rotates)) {
    throw UsageError("no recording of joint " + std::to_string(options.joint) +
                     ", expected at least one to train on and one held out");
  }
  if (rotates && options.by_simulation) {
    throw UsageError("--by simulation: nothing is held out, expected --held-out");
  }
  if (rotates) RequireRotation(options, train);
  report::Report& report = out.report;
  report.robot = out.model.robot.name;
  report.model_file = model_path.string();
  const auto describe = [&] {
    report.train = Describe(train);
    report.held_out = Describe(rotates ? train : held_out);
  };
  describe();
  report.seed = options.seed;
  report.given = options.given;
  try {
    trace::RequireHeldOut(train, held_out);
    // A mapping without the drive is a mistake of the command, no fault of the data.
    for (const auto* runs : {&train, &held_out}) {
      for (const types::Run& run : *runs) run.At(identify::DriveSignal(joint));
    }
    progress("looking at the data", 0.01);
    if (StopsAtGate(options, joint, &train, &held_out, &out)) return out;
    describe();
    NoteProcessing(out.model.root, wished, &report);
    trace::TraceOptions trace_options;
    trace_options.seed = options.seed;
    trace_options.agreed = options.given;
    trace_options.keep_refuted = options.given.has_value();
    trace_options.keep_unconfirmed = options.keep_unconfirmed || options.given;
    trace_options.searches = options.searches;
    trace_options.held_out_error = options.held_out_error;
    trace_options.progress = progress;
    // That of an arm is for the common fit of its joints.
    const bool of_arm = joint.Find("rigid_body") >= 0;
    if (!of_arm && wished.state_cutoff_Hz > 0.0) trace_options.processing = wished;
    trace::LoopResult loop;
    std::vector<trace::Fold> folds = options.folds;
    if (options.by_simulation) {
      loop = shooting::CloseBySimulation(train, held_out, joint, wished.longest_gap_s,
                                         trace_options, plant::JointAlone());
    } else if (rotates) {
      if (folds.empty()) folds = trace::LeaveOneOut(train, joint);
      trace::RotatedLoop rotated =
          trace::RotateLoop(folds, train, joint, wished.longest_gap_s, trace_options);
      loop = std::move(rotated.all);
      report.rotations = std::move(rotated.rotations);
    } else {
      loop = trace::CloseLoop(train, held_out, joint, wished.longest_gap_s, trace_options);
    }
    report.processing = loop.processing;
    report.trace = std::move(loop.trace);
    if (report.trace.too_little) {
      report.seconds = since_start();
      out.html = report::FormatTooLittleHtml(report);
      out.json = report::FormatTooLittleJson(report);
      return out;
    }
    progress("simulation beside the held-out recordings", 0.97);
    if (rotates) {
      report.free_run = FollowRotations(folds, report.rotations);
    } else {
      report.free_run = free_run::Compare(
          held_out, {report.trace.nominal, report.trace.declared, report.trace.corrected},
          report.processing, plant::JointAlone());
    }
    if (published && !rotates)
      ReproducePublished(train.front(), held_out.front(), joint, *published, &report);
    report.seconds = since_start();
    const std::vector<report::Picture> pictures =
        report::MakePictures(report, *loop.train, *loop.held_out);
    out.html = report::FormatHtml(report, pictures, report::DrawPictures(pictures));
    out.json = report::FormatJson(report);
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  const std::vector<actuator::HistoryEntry> history = joint.history;
  joint = report.trace.corrected;
  joint.history = history;
  AddHistory(report, &joint);
  return out;
}

gate::GateReport AskGate(const CloseLoopOptions& options, const std::vector<types::Run>& runs,
                         const actuator::JointModel& joint) {
  return gate::ExamineData(
      runs, joint, {.accepted = {options.accepted_faults.begin(), options.accepted_faults.end()}});
}

void LeaveOutRows(const std::vector<gate::LeftOut>& left_out, std::vector<types::Run>* train,
                  std::vector<types::Run>* held_out) {
  std::vector<types::Run> runs = gate::WithoutRows(Together(*train, *held_out), left_out);
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(train->size());
  held_out->assign(middle, runs.end());
  train->assign(runs.begin(), middle);
}

void MakeFolder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw UsageError(folder.string() + ": " + error.message() + ", expected a folder");
}

CloseLoopResult RunCloseLoop(const CloseLoopOptions& options) {
  const LoopInput input = LoadLoopInput(options);
  const actuator::JointModel& joint =
      input.model.robot.joints[static_cast<std::size_t>(options.joint)];
  if (joint.Find("rigid_body") >= 0) {
    throw UsageError(input.model_path.string() + ": joint '" + joint.name +
                     "' is part of an arm, expected all its joints to be fitted together");
  }
  RequireOtherRows(options.train, options.held_out);
  if (options.progress) options.progress("reading recordings", 0.0);
  CloseLoopResult out =
      CloseLoopOn(options, input, ReadJoint(options.train, input.map, options.joint),
                  ReadJoint(options.held_out, input.held_out_map, options.joint));
  if (options.out.empty()) return out;
  MakeFolder(options.out);
  if (out.assessed()) actuator::SaveModelFile(options.out / "model.yaml", out.model);
  config::WriteFileAtomically(options.out / "report.json", out.json);
  config::WriteFileAtomically(options.out / "report.html", out.html);
  return out;
}

}  // namespace sinew::tools

#include "tools/sinew/close_stance.h"

#include <chrono>
#include <iostream>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/payloads/payloads.h"
#include "components/model/report/file/section_file.h"
#include "components/model/report/file/stance_json.h"
#include "components/model/report/section.h"
#include "components/model/stance_fit/file/stance_reader.h"
#include "components/record/recording/csv_map.h"
#include "tools/sinew/find_urdf.h"

namespace sinew::tools {

namespace {

namespace fs = std::filesystem;

void RefuseOthersOptions(const CloseLoopOptions& options, bool one_joint) {
  const auto refuse = [](const std::string& option, const std::string& why) {
    throw UsageError(option + ": the model file has 'floating_base': " + why);
  };
  if (one_joint) refuse("--joint", "all joints are fitted together, expected none");
  if (options.given) refuse("--effect", "payloads and friction are searched for, expected none");
  if (!options.map.empty()) refuse("--map", "recordings are MCAP files, expected none");
  if (!options.held_out_map.empty()) {
    refuse("--held-out-map", "recordings are MCAP files, expected none");
  }
  if (!options.accepted_faults.empty()) {
    refuse("--accept-fault", "the data gate examines single joints, expected none");
  }
  if (options.keep_unconfirmed) {
    refuse("--keep-unconfirmed", "only what is confirmed goes into model.yaml, expected none");
  }
  if (options.held_out.empty()) {
    const std::string file = options.train.front().string();
    refuse("--held-out",
           "missing, expected a recording for confirmation, or a part of one: --train " + file +
               "@:9 --held-out " + file + "@9:");
  }
}

stance_fit::StanceConfig ConfigOf(const actuator::FloatingBase& base) {
  stance_fit::StanceConfig config;
  config.force_links = base.force_links;
  config.imu_link = base.imu_link;
  return config;
}

// All pieces of all files.
std::vector<stance_fit::StanceRecording> ReadAll(const std::vector<fs::path>& files,
                                                 const actuator::RobotModel& robot) {
  std::vector<stance_fit::StanceRecording> out;
  for (const fs::path& file : files) {
    for (stance_fit::StanceRecording& piece : stance_fit::ReadStance(file, robot)) {
      out.push_back(std::move(piece));
    }
  }
  return out;
}

// Of all joints: some stand still in every squat.
std::string ContentHashOf(const stance_fit::StanceRecording& piece) {
  std::string hash;
  for (const types::Run& joint : piece.joints) {
    hash += (hash.empty() ? "" : "+") + recording::ContentHash(joint);
  }
  return hash;
}

std::vector<report::Recording> Described(const std::vector<stance_fit::StanceRecording>& pieces) {
  std::vector<report::Recording> out;
  out.reserve(pieces.size());
  for (const stance_fit::StanceRecording& piece : pieces) {
    out.push_back({piece.name, ContentHashOf(piece), piece.size(),
                   piece.period_s * static_cast<double>(piece.size() - 1)});
  }
  return out;
}

void RequireDifferent(const std::vector<report::Recording>& train,
                      const std::vector<report::Recording>& held_out) {
  for (const report::Recording& one : held_out) {
    for (const report::Recording& other : train) {
      if (one.content_hash != other.content_hash) continue;
      throw UsageError(one.name + ": held out and trained on (" + other.name +
                       "), expected a recording that was not trained on");
    }
  }
}

std::string RecordingNames(const std::vector<report::Recording>& recordings) {
  std::string out;
  for (const report::Recording& recording : recordings) {
    out += (out.empty() ? "" : ", ") + recording.name;
  }
  return out;
}

// What was added to a joint is in its history; a payload is in that of the first joint.
void AddStanceHistory(const report::StanceReport& report, actuator::RobotModel* robot) {
  const std::string when = types::UtcNow(), from = RecordingNames(report.train);
  const stance_fit::StanceFitResult& result = report.result;
  const std::string errors = "held out on " + RecordingNames(report.held_out) +
                             ": vertical force " + report::Short(result.held_out_before.force_z_N) +
                             " -> " + report::Short(result.held_out_after.force_z_N) +
                             " N, all rows in units of their noise " +
                             report::Short(result.held_out_before.share) + " -> " +
                             report::Short(result.held_out_after.share);
  bool any = false;
  for (const stance_fit::StanceEffect& effect : result.effects) {
    if (!effect.in_model) continue;
    any = true;
    for (actuator::JointModel& joint : robot->joints) {
      const bool first = &joint == &robot->joints.front();
      if (effect.payload ? !first : joint.name != effect.place) continue;
      joint.history.push_back(
          {when, effect.name, from, report::StanceEffectText(effect) + "; " + errors});
    }
  }
  if (any) return;
  robot->joints.front().history.push_back(
      {when, "refit", from, "declared parameters refitted, no effect added; " + errors});
}

}  // namespace

bool StandsOnTwoFeet(const actuator::RobotModel& robot) { return robot.floating_base.has_value(); }

CloseStanceResult RunCloseStance(const CloseLoopOptions& options, bool one_joint) {
  const auto start = std::chrono::steady_clock::now();
  RefuseOthersOptions(options, one_joint);
  const LoopInput input = LoadLoopInput(options);
  const actuator::RobotModel& robot = input.model.robot;
  RequireOtherRows(options.train, options.held_out);
  const auto progress = [&](const char* what, double share) {
    if (options.progress) options.progress(what, share);
  };
  CloseStanceResult out;
  out.model = input.model;
  report::StanceReport& report = out.report;
  report.robot = robot.name;
  report.model_file = input.model_path.string();
  report.declared = robot;
  report.seed = options.seed;
  progress("reading recordings", 0.0);
  const std::vector<stance_fit::StanceRecording> train = ReadAll(options.train, robot);
  const std::vector<stance_fit::StanceRecording> held_out = ReadAll(options.held_out, robot);
  report.train = Described(train);
  report.held_out = Described(held_out);
  RequireDifferent(report.train, report.held_out);
  try {
    const fs::path urdf = FindUrdf(options, input);
    const arm::Chain chain =
        arm::WithPayloads(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()), robot.payloads);
    const actuator::FloatingBase& base = robot.floating_base.value();
    const stance_fit::StanceModel model(chain, robot, ConfigOf(base));
    stance_fit::StanceOptions stance_options;
    stance_options.seed = options.seed;
    stance_options.tolerances = {base.mass_tolerance, base.com_tolerance_m,
                                 base.tilt_tolerance_rad};
    progress("balance of the floating base", 0.1);
    report.result = stance_fit::FitStance(model, train, held_out, stance_options);
  } catch (const std::invalid_argument& error) {
    throw UsageError(input.model_path.string() + ": " + error.what());
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const std::vector<report::Picture> pictures = report::MakePictures(report);
  out.html = report::FormatHtml(report, pictures, report::DrawPictures(pictures));
  out.json = report::FormatJson(report);
  if (out.assessed()) {
    out.model.robot = report.result.corrected;
    AddStanceHistory(report, &out.model.robot);
  }
  if (options.out.empty()) return out;
  MakeFolder(options.out);
  if (out.assessed()) actuator::SaveModelFile(options.out / "model.yaml", out.model);
  config::WriteFileAtomically(options.out / "report.json", out.json);
  config::WriteFileAtomically(options.out / "report.html", out.html);
  return out;
}

void PrintSummary(const CloseStanceResult& result, const CloseLoopOptions& options) {
  const stance_fit::StanceFitResult& found = result.report.result;
  std::cout << "verdict: " << report::VerdictWord(found.verdict) << '\n'
            << report::VerdictSentence(result.report) << '\n';
  if (result.assessed()) {
    for (const stance_fit::StanceEffect& effect : found.refuted) {
      std::cout << "  refuted: " << report::StanceEffectText(effect) << '\n';
    }
    for (const report::StanceShift& shift : report::StanceShifts(result.report)) {
      std::cout << "  shift: " << shift.parameter << ' ' << report::Short(shift.declared) << " -> "
                << report::Short(shift.corrected) << " (" << report::Short(shift.tolerances)
                << " tolerances)\n";
    }
    std::cout << "errors on the held-out recordings, rms, declared -> corrected:\n";
    for (const report::StanceErrorLine& line : report::StanceErrors(found, true)) {
      std::cout << "  " << line.what << ": " << report::Short(line.declared) << " -> "
                << report::Short(line.corrected) << (line.unit == "1" ? "" : " " + line.unit)
                << '\n';
    }
    std::cout << "not excited by this data: ";
    for (std::size_t i = 0; i < found.not_excited.size(); ++i) {
      std::cout << (i > 0 ? ", " : "") << found.not_excited[i].effect;
    }
    std::cout << (found.not_excited.empty() ? "nothing\n" : "\n");
  }
  std::cout << "written: " << (options.out / "report.html").string() << ", report.json"
            << (result.assessed() ? ", model.yaml" : "") << " ("
            << report::Short(result.report.seconds) << " s)\n";
}

}  // namespace sinew::tools

#include <algorithm>

#include "components/base/config/config.h"
#include "components/base/types/clock/utc.h"
#include "components/model/close_loop/builders.h"
#include "components/model/stance_fit/file/stance_reader.h"
#include "components/record/recording/csv_map.h"

namespace sinew::close_loop {

namespace {

namespace fs = std::filesystem;

void RefuseOthersOptions(const Options& options) {
  const auto refuse = [](bool given, const std::string& option, const std::string& why) {
    if (given) throw UsageError(option + ": the model file has 'floating_base': " + why);
  };
  const std::string mcap = "recordings are MCAP files, expected none";
  refuse(options.by_simulation, "--by simulation", "torques are compared, expected none");
  refuse(options.joint.has_value(), "--joint", "all joints are fitted together, expected none");
  refuse(options.given.has_value(), "--effect",
         "payloads and friction are searched for, expected none");
  refuse(!options.map.empty(), "--map", mcap);
  refuse(!options.held_out_map.empty(), "--held-out-map", mcap);
  refuse(!options.accepted_faults.empty(), "--accept-fault",
         "the data gate examines single joints, expected none");
  refuse(options.keep_unconfirmed, "--keep-unconfirmed",
         "only what is confirmed goes into model.yaml, expected none");
  const std::string file = options.train.front().string();
  refuse(options.held_out.empty(), "--held-out",
         "missing, expected a recording for confirmation, or a part of one: --train " + file +
             "@:9 --held-out " + file + "@9:");
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

std::vector<report::Recording> Described(const std::vector<stance_fit::StanceRecording>& pieces) {
  std::vector<report::Recording> out;
  out.reserve(pieces.size());
  for (const stance_fit::StanceRecording& piece : pieces) {
    std::string hash;  // of all joints: some stand still in every squat
    for (const types::Run& joint : piece.joints) {
      hash += (hash.empty() ? "" : "+") + recording::ContentHash(joint);
    }
    out.push_back(
        {piece.name, hash, piece.size(), piece.period_s * static_cast<double>(piece.size() - 1)});
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

// Adds what was added to a joint to its history; a payload is in that of the first joint.
void AddHistory(const report::StanceReport& report, actuator::RobotModel* robot) {
  const History now = {types::UtcNow(), report::NamesOf(report.train)};
  const stance_fit::StanceFitResult& result = report.result;
  const std::string errors = "held out on " + report::NamesOf(report.held_out) +
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
      now.Add(effect.name, report::StanceEffectText(effect) + "; " + errors, &joint);
    }
  }
  if (any) return;
  now.Add("refit", "declared parameters refitted, no effect added; " + errors,
          &robot->joints.front());
}

stance_fit::StanceFitResult Fit(const Options& options, const Input& input,
                                const std::vector<stance_fit::StanceRecording>& train,
                                const std::vector<stance_fit::StanceRecording>& held_out) try {
  const actuator::FloatingBase& base = input.model.robot.floating_base.value();
  stance_fit::StanceConfig config;
  config.force_links = base.force_links;
  config.imu_link = base.imu_link;
  stance_fit::StanceOptions stance_options;
  stance_options.in_force = options.in_force;
  stance_options.seed = options.seed;
  stance_options.tolerances = {base.mass_tolerance, base.com_tolerance_m, base.tilt_tolerance_rad};
  const stance_fit::StanceModel model(BodiesOf(options, input), input.model.robot, config);
  return stance_fit::FitStance(model, train, held_out, stance_options);
} catch (const std::invalid_argument& error) {
  throw UsageError(input.model_path.string() + ": " + error.what());
}

}  // namespace

void FitStanding(const Options& options, const Input& input, Result* out) {
  RefuseOthersOptions(options);
  const actuator::RobotModel& robot = input.model.robot;
  report::StanceReport& report = out->stance.emplace();
  report.robot = robot.name;
  report.model_file = input.model_path.string();
  report.declared = robot;
  report.seed = options.seed;
  const std::vector<stance_fit::StanceRecording> train = ReadAll(options.train, robot);
  const std::vector<stance_fit::StanceRecording> held_out = ReadAll(options.held_out, robot);
  report.train = Described(train);
  report.held_out = Described(held_out);
  RequireDifferent(report.train, report.held_out);
  if (options.progress) options.progress(0.1);
  report.result = Fit(options, input, train, held_out);
  out->assessed = report.result.too_little.empty();
  if (!out->assessed) return;
  out->model.robot = report.result.corrected;
  AddHistory(report, &out->model.robot);
}

}  // namespace sinew::close_loop

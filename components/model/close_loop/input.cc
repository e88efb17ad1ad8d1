#include "components/model/close_loop/input.h"

#include <cmath>

#include "components/base/config/config.h"
#include "components/base/types/seconds.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/close_loop/builders.h"
#include "components/model/identify/interpolated.h"
#include "components/model/payloads/payloads.h"
#include "components/record/recording/file/run_reader.h"

namespace sinew::close_loop {

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

// A laboratory's rig.json has no processing block: that of the shipped rig is used.
void CompleteRigJson(const fs::path& rig, actuator::ModelFile* file) {
  actuator::ModelFile shipped = actuator::LoadModelFile(rig / "model.yaml");
  file->root = shipped.root;
  file->foreign_text = shipped.foreign_text;
  file->robot.urdf_path = shipped.robot.urdf_path;
}

}  // namespace

Input LoadInput(const Options& options) {
  Input out;
  out.model_path = options.model.empty() ? options.rig / "model.yaml" : options.model;
  const fs::path beside = out.model_path.parent_path() / "csv_map.yaml";
  out.map = !options.map.empty() ? options.map
            : fs::exists(beside) ? beside
                                 : options.rig / "csv_map.yaml";
  out.held_out_map = options.held_out_map.empty() ? out.map : options.held_out_map;
  out.model = actuator::LoadModelFile(out.model_path);
  if (out.model_path.extension() == ".json") CompleteRigJson(options.rig, &out.model);
  const auto joints = static_cast<int>(out.model.robot.joints.size());
  const int joint = options.joint.value_or(0);
  if (joint < 0 || joint >= joints) {
    throw UsageError("--joint " + std::to_string(joint) + ": model " + out.model_path.string() +
                     " has joints 0 to " + std::to_string(joints - 1));
  }
  return out;
}

std::vector<types::Run> ReadJoint(const std::vector<fs::path>& files, const fs::path& map,
                                  int joint) {
  std::vector<types::Run> runs;
  for (const fs::path& file : files) {
    for (types::Run& run : recording::ReadRuns(file, map, joint)) {
      run.name = fs::path(run.name).filename().string();
      RequireAngle(run);
      runs.push_back(identify::WithoutInterpolatedRows(std::move(run)));
    }
  }
  return runs;
}

std::vector<report::Recording> Described(const std::vector<types::Run>& runs) {
  std::vector<report::Recording> out;
  out.reserve(runs.size());
  for (const types::Run& run : runs) {
    out.push_back({run.name, run.content_hash, run.size(),
                   run.time_s[run.size() - 1] - run.time_s[0], run.time_s[0]});
  }
  return out;
}

gate::GateReport AskGate(const Options& options, const std::vector<types::Run>& runs,
                         const actuator::JointModel& joint) {
  return gate::ExamineData(
      runs, joint, {.accepted = {options.accepted_faults.begin(), options.accepted_faults.end()}});
}

arm::Chain BodiesOf(const Options& options, const Input& input) {
  fs::path urdf = options.urdf.empty() ? fs::path(input.model.robot.urdf_path) : options.urdf;
  if (urdf.empty()) {
    throw UsageError(
        input.model_path.string() +
        ": joints with a term rigid_body, and a robot on two feet, need the robot's URDF, expected "
        "'urdf' in the model file or --urdf");
  }
  const fs::path beside = input.model_path.parent_path() / urdf;
  if (urdf.is_relative() && fs::exists(beside)) {
    urdf = beside;
  } else if (!fs::exists(urdf)) {
    throw UsageError(urdf.string() + ": no such file, expected the robot's URDF");
  }
  return arm::WithPayloads(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()),
                           input.model.robot.payloads);
}

void RequireRotation(const Options& options, const std::vector<types::Run>& runs) {
  if (runs.size() > 1) return;
  const std::string file = options.train.empty() ? runs.front().name : options.train[0].string();
  if (runs.front().held) {
    throw UsageError(file +
                     ": nothing is held out, expected --held-out or further recordings to train on "
                     "(each is held out once)");
  }
  const Eigen::VectorXd& time_s = runs.front().time_s;
  const double length_s = time_s[time_s.size() - 1] - time_s[0];
  double middle_s = std::floor(time_s[0] + 0.7 * length_s);  // on the recording's own stamps
  if (middle_s < time_s[0] + 0.5 * length_s) middle_s = time_s[0] + 0.7 * length_s;
  const std::string middle = types::SecondsText(middle_s);
  const std::string whole = file.substr(0, file.find('@'));
  throw UsageError(
      "one recording and nothing held out, expected --held-out, further recordings to "
      "train on (each is held out once), or parts: --train " +
      whole + "@:" + middle + " --held-out " + whole + "@" + middle + ":");
}

std::vector<types::Run> Together(const std::vector<types::Run>& train,
                                 const std::vector<types::Run>& held_out) {
  std::vector<types::Run> runs = train;
  runs.insert(runs.end(), held_out.begin(), held_out.end());
  return runs;
}

void LeaveOutRows(const std::vector<gate::LeftOut>& left_out, std::vector<types::Run>* train,
                  std::vector<types::Run>* held_out) {
  std::vector<types::Run> runs = gate::WithoutRows(Together(*train, *held_out), left_out);
  const auto middle = runs.begin() + static_cast<std::ptrdiff_t>(train->size());
  held_out->assign(middle, runs.end());
  train->assign(runs.begin(), middle);
}

}  // namespace sinew::close_loop

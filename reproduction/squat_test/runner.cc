#include "reproduction/squat_test/runner.h"

#include <stdexcept>

#include "components/base/config/config.h"
#include "reproduction/recorded_run/recorded_run.h"
#include "tools/edited_yaml/edited_yaml.h"
#include "tools/sinew/performance_sessions.h"

namespace sinew::squat_test {
namespace {

namespace fs = std::filesystem;

const char* LoadName(Load load) {
  return load == Load::kNone ? "free" : load == Load::kFromStart ? "loaded" : "put-on";
}

fs::path LoadFile(const fs::path& robot, Load load) {
  if (load == Load::kNone) return robot / "squat_test/no_load.yaml";
  return robot / (load == Load::kFromStart ? "payload_start.yaml" : "payload.yaml");
}

// robots/biped/world.yaml without its guard against falls, as a file of another folder: what is
// compared falls by itself or not at all.
std::string UnguardedWorld(const fs::path& robot) {
  const fs::path file = robot / "world.yaml";
  YAML::Node root = edited_yaml::LoadYaml(file);
  root["guard"].remove("fall");
  for (const char* key : {"urdf", "model"}) {
    if (!root[key] || !root[key].IsScalar()) {
      throw UsageError(file.string() + ": key '" + key + "': missing, expected a file");
    }
    root[key] = (robot / root[key].as<std::string>()).string();
  }
  return edited_yaml::YamlText(root);
}

}  // namespace

Squats RunSquats(const RunnerConfig& config, const Arm& arm, Load load) {
  const fs::path robot = fs::absolute(config.robot);
  Squats squats;
  squats.arm = &arm;
  squats.load = load;
  squats.count = load == Load::kPutOn ? kSixSquats : kBenchmarkSquats;
  const double end_s = kStart_s + squats.count * kSquat_s;

  reproduction::RecordedRun run;
  run.name = arm.id + "-" + LoadName(load);
  const fs::path folder = fs::absolute(config.folder) / run.name;
  fs::create_directories(folder);
  run.deployment = robot / "squat_test" / arm.deployment;
  run.recording = folder / "run.mcap";
  run.log = folder / "processes.log";
  run.programs = config.programs;
  // Everything that the run depends on, but for the programs.
  std::string key;
  const auto use = [&key](const fs::path& file) {
    key += config::ReadFile(file);
    return file.string();
  };
  use(run.deployment);
  for (const char* name : {"biped.urdf", "model.yaml"}) use(robot / name);
  config::WriteFileAtomically(folder / "world.yaml", UnguardedWorld(robot));
  run.overrides.settings = {
      "duration_s=" + std::to_string(end_s + kRest_s),
      "domain_id=" + std::to_string(config.domain_id),
      "world.config=" + use(folder / "world.yaml"),
      "hand.config=" + use(LoadFile(robot, load)),
      "reference.config=" +
          use(robot / (load == Load::kPutOn ? "reference_six.yaml" : "reference_benchmark.yaml")),
      "control.config=" + use(robot / arm.control)};
  if (!arm.esn.empty()) {
    run.overrides.settings.push_back("esn.config=" + use(robot / arm.esn));
    run.overrides.settings.push_back("esn.program=" + arm.esn_program);
    for (const char* name : {"esn_legs.json", "rls.yaml"}) use(robot / name);
  }
  const fs::path made_with = folder / "made_with.txt";
  if (!fs::exists(run.recording) || !fs::exists(made_with) || config::ReadFile(made_with) != key) {
    fs::remove(run.recording);
    reproduction::RunRecorded(run);
    config::WriteFileAtomically(made_with, key);
  }

  squats.file = run.recording;
  squats.recording = ReadSquats(run.recording);
  try {
    squats.mse_rad2 = MeanSquareError(squats.recording, kStart_s, end_s);
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(run.name + ": " + error.what());
  }
  squats.fall_s = FallTime(squats.recording, kDepth_m);
  const auto sessions = tools::MeasureRecordings({run.recording.string()},
                                                 {.config = (robot / "performance.yaml").string()});
  if (sessions.size() != 1) {
    throw std::runtime_error(run.recording.string() + ": " + std::to_string(sessions.size()) +
                             " sessions, expected one");
  }
  squats.session = sessions.front();
  return squats;
}

}  // namespace sinew::squat_test

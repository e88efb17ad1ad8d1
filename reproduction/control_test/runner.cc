#include "reproduction/control_test/runner.h"

#include <cstdio>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/record/recording/file/run_reader.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "reproduction/recorded_run/recorded_run.h"
#include "sim/surrogate/file/surrogate_file.h"
#include "tools/edited_yaml/edited_yaml.h"

namespace sinew::control_test {
namespace {

namespace fs = std::filesystem;

using edited_yaml::LoadYaml;
using edited_yaml::YamlText;

struct TrialFiles {
  fs::path surrogate, pneumatics, reference, control, recorded_torque, recording, log, key;
};

TrialFiles FilesOf(const fs::path& folder) {
  return {folder / "surrogate.yaml", folder / "pneumatics.yaml",     folder / "reference.yaml",
          folder / "control.yaml",   folder / "recorded_torque.csv", folder / "run.mcap",
          folder / "processes.log",  folder / "made_with.txt"};
}

std::string SurrogateText(const fs::path& rig, const Trial& trial) {
  YAML::Node root = LoadYaml(rig / "surrogate.yaml");
  root["pneumatics"]["initial_pressure_bar"] = trial.pressure_bar;
  if (trial.load != Load::kNone) {
    char effect[60];
    std::snprintf(effect, sizeof effect, "payload=%g@%g", kPayload_kg, trial.payload_from_s());
    root["effects"] = std::vector<std::string>{effect};
  }
  return YamlText(root);
}

std::string PneumaticsText(const fs::path& rig, const Trial& trial) {
  YAML::Node root = LoadYaml(rig / "pneumatics.yaml");
  root["joints"][0]["target_bar"] = trial.pressure_bar;
  return YamlText(root);
}

std::string ReferenceText(const fs::path& rig, const Trial& trial) {
  YAML::Node root = LoadYaml(rig / "reference_benchmark.yaml");
  root["joints"][0]["duration_s"] = (kLeadInCycles + trial.cycles) / kFrequency_Hz;
  return YamlText(root);
}

fs::path ControlBase(const fs::path& rig, Arm arm) {
  switch (arm) {
    case Arm::kLinear:
      return rig / "control_pid_linear.yaml";
    case Arm::kNetwork:
    case Arm::kAdapted:
      return rig / "control_pid_esn.yaml";
    case Arm::kPid:
    case Arm::kInverse:
      break;
  }
  return rig / "control_pid.yaml";
}

// The arm's controller; files that it names become absolute.
std::string ControlText(const RunnerConfig& config, const Trial& trial, const TrialFiles& files) {
  const fs::path base = ControlBase(config.rig, trial.arm);
  YAML::Node root = LoadYaml(base);
  YAML::Node joint = root["joints"][0];
  const fs::path model = base.parent_path() / joint["model"].as<std::string>();
  joint["model"] = fs::absolute(trial.arm == Arm::kLinear ? config.model : model).string();
  if (trial.arm == Arm::kInverse) {
    joint["strategy"] = "pid_linear";
    joint["compensate"] = "recorded";
    joint["recorded_torque"] = fs::absolute(files.recorded_torque).string();
  }
  return YamlText(root);
}

std::string TorqueText(const control::RecordedTorque& torque) {
  std::string text = "time_s,motor_torque_Nm\n";
  char line[80];
  for (std::size_t i = 0; i < torque.motor_torque_Nm.size(); ++i) {
    std::snprintf(line, sizeof line, "%.9f,%.9g\n", static_cast<double>(i) * torque.period_s,
                  torque.motor_torque_Nm[i]);
    text += line;
  }
  return text;
}

const char* DeploymentName(Arm arm) {
  switch (arm) {
    case Arm::kNetwork:
      return "deploy_network.yaml";
    case Arm::kAdapted:
      return "deploy_adapted.yaml";
    case Arm::kPid:
    case Arm::kLinear:
    case Arm::kInverse:
      break;
  }
  return "deploy_pid.yaml";
}

void Launch(const RunnerConfig& config, const Trial& trial, const TrialFiles& files) {
  reproduction::RecordedRun run;
  run.name = trial.name();
  run.deployment = config.rig / "control_test" / DeploymentName(trial.arm);
  run.overrides.settings = {"mode=lockstep",
                            "seed=" + std::to_string(trial.seed),
                            "duration_s=" + std::to_string(trial.duration_s()),
                            "domain_id=" + std::to_string(config.domain_id),
                            "surrogate.config=" + files.surrogate.string(),
                            "pneumatics.config=" + files.pneumatics.string(),
                            "reference.config=" + files.reference.string(),
                            "control.config=" + files.control.string()};
  run.recording = files.recording;
  run.log = files.log;
  run.programs = config.programs;
  reproduction::RunRecorded(run);
}

}  // namespace

Runner::Runner(RunnerConfig config) : config_(std::move(config)) {
  config_.rig = fs::absolute(config_.rig);
  config_.folder = fs::absolute(config_.folder);
}

const Inverse& Runner::InverseOf(const Trial& trial) {
  Trial same = trial;
  same.seed = 0;
  const auto known = inverses_.find(same.name());
  if (known != inverses_.end()) return known->second;
  const TrialFiles files = FilesOf(config_.folder / trial.name());
  InverseConfig inverse;
  inverse.iterations = config_.inverse_rounds;
  inverse.rig = surrogate::LoadRig(files.surrogate);
  inverse.rig.seed = trial.seed;
  inverse.loop.control = control::LoadControl(config_.rig / "control_pid.yaml").joints;
  inverse.loop.reference = reference::LoadReference(files.reference).config;
  inverse.loop.pneumatics = pneumatics::LoadPneumatics(files.pneumatics).joints;
  inverse.loop.duration_s = trial.duration_s();
  inverse.loop.score_from_s = kStart_s;
  inverse.loop.score_to_s = trial.end_s();
  return inverses_[same.name()] = InvertSurrogate(inverse);
}

Outcome Runner::Run(const Trial& trial) {
  const fs::path folder = config_.folder / trial.name();
  fs::create_directories(folder);
  const TrialFiles files = FilesOf(folder);
  // Everything that the run depends on, but for the programs.
  std::string key = trial.name() + "\n";
  const auto put = [&key](const fs::path& path, const std::string& text) {
    config::WriteFileAtomically(path, text);
    key += text;
  };
  put(files.surrogate, SurrogateText(config_.rig, trial));
  put(files.pneumatics, PneumaticsText(config_.rig, trial));
  put(files.reference, ReferenceText(config_.rig, trial));
  Outcome outcome;
  outcome.trial = trial;
  if (trial.arm == Arm::kInverse) {
    const Inverse& inverse = InverseOf(trial);
    outcome.inverse_mse_rad2 = inverse.mse_rad2;
    put(files.recorded_torque, TorqueText(inverse.torque));
  }
  put(files.control, ControlText(config_, trial, files));
  if (trial.arm == Arm::kLinear) key += config::ReadFile(config_.model);
  if (trial.arm == Arm::kNetwork || trial.arm == Arm::kAdapted) {
    for (const char* name : {"esn_sea.json", "esn_pea.json", "esn.yaml", "esn_adaptive.yaml",
                             "rls.yaml", "regime.yaml"}) {
      key += config::ReadFile(config_.rig / name);
    }
  }
  const bool there =
      fs::exists(files.recording) && fs::exists(files.key) && config::ReadFile(files.key) == key;
  if (!there) {
    fs::remove(files.recording);
    Launch(config_, trial, files);
    config::WriteFileAtomically(files.key, key);
  }
  const surrogate::MotorParameters motor = surrogate::LoadRig(files.surrogate).motor;
  const auto runs = recording::ReadRuns(files.recording);
  if (runs.size() != 1) {
    throw std::runtime_error(files.recording.string() + ": " + std::to_string(runs.size()) +
                             " sessions, expected one");
  }
  try {
    outcome.score =
        ScoreTrial(trial, runs.front(), {motor.torque_constant_Nm_A, motor.current_limit_A});
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(trial.name() + ": " + error.what());
  }
  return outcome;
}

}  // namespace sinew::control_test

#include "tools/tune_robot/tune_file.h"

#include <algorithm>
#include <regex>
#include <sstream>

#include "components/robot/control/file/control_file.h"
#include "components/robot/performance/file/performance_file.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/reference/file/reference_file.h"
#include "sim/world/file/world_file.h"

namespace sinew::tune {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;
using Inputs = std::map<std::string, std::filesystem::path>;

// A file that the section names, and its place among the inputs.
std::filesystem::path Input(const Section& section, const char* key, Inputs* inputs) {
  return (*inputs)[key] = section.ExistingPath(key);
}

world::FloatingRobotConfig ReadRobot(const Section& section, Inputs* inputs) {
  const std::filesystem::path path = Input(section, "world", inputs);
  const std::filesystem::path model =
      section.Has("model") ? section.ExistingPath("model")
                           : Section::Load(path, "sinew-world/1").ExistingPath("model");
  const world::WorldFile file = world::LoadWorldFile(path, model);
  if (!file.floating_base) {
    section.Fail("world", "'" + path.string() + "' has a fixed base, expected floating_base");
  }
  (*inputs)["model"] = model;
  (*inputs)["urdf"] = file.urdf;
  return world::RobotConfig(file);
}

std::vector<control::JointControlConfig> ReadJoints(const Section& section, Inputs* inputs) {
  const std::filesystem::path path = Input(section, "control", inputs);
  const control::ControlConfig config = control::LoadControl(path);
  if (config.needs_prediction()) {
    section.Fail("control", "'" + path.string() +
                                "' needs a torque prediction, which a trial in one process does "
                                "not have; expected position, pid or pid_linear");
  }
  return config.joints;
}

FallLimits ReadFall(const Section& section) {
  const Section fall = section.Child("fall");
  FallLimits limits;
  limits.least_height_m = fall.Number("least_height_m", kPositive);
  limits.most_tilt_rad = fall.Number("most_tilt_rad", {0.01, std::numbers::pi});
  fall.RejectUnknownKeys();
  return limits;
}

// Everything but robot and control.
RobotTrialConfig ReadTrial(const Section& section, Inputs* inputs) {
  RobotTrialConfig trial;
  trial.reference = reference::LoadReference(Input(section, "reference", inputs)).config;
  trial.performance = performance::LoadPerformance(Input(section, "performance", inputs));
  if (section.Has("pneumatics")) {
    trial.pneumatics = pneumatics::LoadPneumatics(Input(section, "pneumatics", inputs)).joints;
  }
  trial.rate_Hz = section.Number("rate_Hz", {1.0, 10000.0});
  trial.delay_ticks = static_cast<int>(section.IntegerOr("delay_ticks", 0, {0, 100}));
  trial.duration_s = section.Number("duration_s", kPositive);
  trial.fall = ReadFall(section);
  return trial;
}

// What the parts say when they do not fit together, with the file's name; runs nothing.
void CheckFits(const Section& section, const RobotTrialConfig& trial) {
  const std::size_t joints = trial.robot.model.joints.size();
  const auto check = [&](const char* key, std::size_t count) {
    if (count == joints) return;
    section.Fail(key, "has " + std::to_string(count) + " joints, expected the model's " +
                          std::to_string(joints));
  };
  check("control", trial.control.size());
  check("reference", trial.reference.joints.size());
  check("performance", trial.performance.robot.joints.size());
  if (!trial.pneumatics.empty()) check("pneumatics", trial.pneumatics.size());
}

GainRange ReadRange(const Section& section, const char* key, GainRange range) {
  if (!section.Has(key)) return range;
  const std::vector<double> values = section.Numbers(key, kPositive);
  if (values.size() != 2 || values[0] > values[1]) {
    section.Fail(key, "expected two numbers, the lower one first");
  }
  return {values[0], values[1]};
}

GainSearchConfig ReadSearch(const Section& root) {
  GainSearchConfig config;
  const Section search = root.Child("search");
  config.search.trials = static_cast<int>(search.Integer("trials", {1, 1e6}));
  config.search.seed = static_cast<std::uint64_t>(search.IntegerOr("seed", 1, kNotNegative));
  config.search.proportional = ReadRange(search, "proportional_Nm_rad", config.search.proportional);
  config.search.integral = ReadRange(search, "integral_Nm_rad_s", config.search.integral);
  config.search.derivative = ReadRange(search, "derivative_Nm_s_rad", config.search.derivative);
  config.search.around_best = ReadRange(search, "around_best", config.search.around_best);
  search.RejectUnknownKeys();
  for (const Section& gains : root.ListOrEmpty("compare")) {
    config.compared.push_back({gains.Text("name"), gains.Number("proportional_Nm_rad", kPositive),
                               gains.Number("integral_Nm_rad_s", kNotNegative),
                               gains.Number("derivative_Nm_s_rad", kNotNegative)});
    gains.RejectUnknownKeys();
  }
  return config;
}

// Every number after the key; false: there is none.
bool ReplaceNumber(const std::string& key, double value, std::string* text) {
  std::ostringstream number;
  number.precision(kGainDigits);
  number << value;
  const std::regex pattern("(" + key + ":\\s*)[-+0-9.eE]+");
  const bool found = std::regex_search(*text, pattern);
  *text = std::regex_replace(*text, pattern, "$01" + number.str());
  return found;
}

// `model: FILE`, relative to the old folder, relative to the new one.
std::string MoveModelPaths(const std::string& text, const std::filesystem::path& from,
                           const std::filesystem::path& to) {
  static const std::regex kModel(R"((\bmodel:\s*)([^\s,}#]+))");
  std::string moved;
  auto begin = text.cbegin();
  for (std::sregex_iterator it(text.begin(), text.end(), kModel), end; it != end; ++it) {
    const std::filesystem::path file = std::filesystem::absolute(from / (*it)[2].str());
    moved.append(begin, (*it)[0].first);
    moved +=
        (*it)[1].str() + std::filesystem::proximate(file, std::filesystem::absolute(to)).string();
    begin = (*it)[0].second;
  }
  return moved.append(begin, text.cend());
}

}  // namespace

TuneFile LoadTune(const std::filesystem::path& path) {
  const Section root = Section::Load(path, "sinew-tune/1");
  TuneFile file;
  file.inputs["search"] = path;
  file.trial = ReadTrial(root, &file.inputs);
  file.trial.robot = ReadRobot(root, &file.inputs);
  file.trial.control = ReadJoints(root, &file.inputs);
  file.control = file.inputs.at("control");
  file.search = ReadSearch(root);
  file.search.rest = file.trial.control.front().pid;
  root.RejectUnknownKeys();
  CheckFits(root, file.trial);
  for (const control::JointControlConfig& joint : file.trial.control) {
    if (joint.strategy == control::Strategy::kPid) continue;
    root.Fail("control", "'" + file.control.string() + "' has a joint without PID, expected pid");
  }
  return file;
}

PressureSweepFile LoadPressureSweep(const std::filesystem::path& path) {
  const Section root = Section::Load(path, "sinew-pressure-sweep/1");
  Inputs inputs;
  PressureSweepFile file;
  PressureSweepConfig& sweep = file.sweep;
  sweep.elastic = ReadTrial(root, &inputs);
  sweep.rigid = sweep.elastic;
  sweep.rigid.pneumatics.clear();
  const Section rigid = root.Child("rigid"), elastic = root.Child("elastic");
  for (const auto& [section, trial] :
       {std::pair{&rigid, &sweep.rigid}, std::pair{&elastic, &sweep.elastic}}) {
    trial->robot = ReadRobot(*section, &inputs);
    trial->control = ReadJoints(*section, &inputs);
    section->RejectUnknownKeys();
    CheckFits(*section, *trial);
  }
  sweep.pressure_bar = root.Numbers("pressure_bar", kNotNegative);
  root.RejectUnknownKeys();
  if (sweep.elastic.pneumatics.empty()) root.Fail("pneumatics", "is missing, expected a file");
  return file;
}

std::string ControlText(const std::filesystem::path& control, const control::PidConfig& pid,
                        const std::filesystem::path& folder, const std::string& comment) {
  std::string text = config::ReadFile(control);
  while (!text.empty() && text.front() == '#') text.erase(0, text.find('\n') + 1);
  if (!ReplaceNumber("proportional_Nm_rad", pid.proportional_Nm_rad, &text) ||
      !ReplaceNumber("integral_Nm_rad_s", pid.integral_Nm_rad_s, &text) ||
      !ReplaceNumber("derivative_Nm_s_rad", pid.derivative_Nm_s_rad, &text)) {
    throw UsageError(control.string() +
                     ": a gain is left out, expected proportional_Nm_rad, integral_Nm_rad_s and "
                     "derivative_Nm_s_rad");
  }
  std::string head;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) head += "# " + line + "\n";
  text = head + MoveModelPaths(text, control.parent_path(), folder);
  const std::string name = (folder / "control.yaml").string();
  const control::ControlConfig read =
      control::ReadControl(Section::Parse(text, name, "sinew-control/1"));
  for (const control::JointControlConfig& joint : read.joints) {
    if (joint.pid.proportional_Nm_rad == pid.proportional_Nm_rad &&
        joint.pid.integral_Nm_rad_s == pid.integral_Nm_rad_s &&
        joint.pid.derivative_Nm_s_rad == pid.derivative_Nm_s_rad) {
      continue;
    }
    throw UsageError(control.string() + ": its gains could not be replaced");
  }
  return text;
}

}  // namespace sinew::tune

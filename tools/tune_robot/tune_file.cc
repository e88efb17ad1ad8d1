#include "tools/tune_robot/tune_file.h"

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
std::filesystem::path Input(config::Fields& f, const char* key, const char* help, Inputs* inputs) {
  std::filesystem::path path;
  f.Need(key, path, help);
  return (*inputs)[key] = path;
}

world::FloatingRobotConfig DescribeRobot(config::Fields& f, Inputs* inputs) {
  const std::filesystem::path path =
      Input(f, "world", "schema sinew-world/1, with floating_base", inputs);
  std::optional<std::filesystem::path> given;
  f("model", given, "in place of the world's");
  if (!f.reads()) return {};
  const std::filesystem::path model =
      given ? *given : Section::Load(path, world::kSchema).ExistingPath("model");
  const world::WorldFile file = world::LoadWorldFile(path, model);
  if (!file.floating_base) {
    f.Fail("world", "'" + path.string() + "' has a fixed base, expected floating_base");
  }
  (*inputs)["model"] = model;
  (*inputs)["urdf"] = file.urdf;
  return world::RobotConfig(file);
}

std::vector<control::JointControlConfig> DescribeJoints(config::Fields& f, Inputs* inputs) {
  const std::filesystem::path path =
      Input(f, "control", "every joint without a prediction", inputs);
  if (!f.reads()) return {};
  const control::ControlConfig config = control::LoadControl(path);
  if (config.needs_prediction()) {
    f.Fail("control", "'" + path.string() +
                          "' needs a torque prediction, which a trial in one process does "
                          "not have; expected position, pid or pid_linear");
  }
  return config.joints;
}

// Everything but robot and control.
void DescribeTrial(config::Fields& f, RobotTrialConfig* c, Inputs* inputs) {
  const auto reference = Input(f, "reference", "schema sinew-reference/1", inputs);
  const auto performance = Input(f, "performance", "energies", inputs);
  std::optional<std::filesystem::path> pneumatics;
  f("pneumatics", pneumatics, "a manager for every joint; left out: relays off");
  f.Need("rate_Hz", c->rate_Hz, {1.0, 10000.0}, "of the cycle");
  f("delay_ticks", c->delay_ticks, {0, 100}, "commands act so many ticks later");
  f.Need("duration_s", c->duration_s, kPositive, "of a trial");
  f.NeedObject("fall", "a trial ends with it", [&](config::Fields& fall) {
    fall.Need("least_height_m", c->fall.least_height_m, kPositive, "of the base's origin");
    fall.Need("most_tilt_rad", c->fall.most_tilt_rad, {0.01, std::numbers::pi}, "of its z axis");
  });
  if (!f.reads()) return;
  c->reference = reference::LoadReference(reference).config;
  c->performance = performance::LoadPerformance(performance);
  if (!pneumatics) return;
  (*inputs)["pneumatics"] = *pneumatics;
  c->pneumatics = pneumatics::LoadPneumatics(*pneumatics).joints;
}

// Refuses parts that do not fit together, with the file's name; runs nothing.
void CheckFits(const config::Fields& f, const RobotTrialConfig& trial) {
  if (!f.reads()) return;
  const std::size_t joints = trial.robot.model.joints.size();
  const auto check = [&](const char* key, std::size_t count) {
    if (count == joints) return;
    f.Fail(key, "has " + std::to_string(count) + " joints, expected the model's " +
                    std::to_string(joints));
  };
  check("control", trial.control.size());
  check("reference", trial.reference.joints.size());
  check("performance", trial.performance.robot.joints.size());
  if (!trial.pneumatics.empty()) check("pneumatics", trial.pneumatics.size());
}

void DescribeRange(config::Fields& f, const char* key, GainRange& range, const char* help) {
  std::vector<double> values = {range.lower, range.upper};
  f(key, values, kPositive, help);
  if (values.size() != 2 || values[0] > values[1]) {
    f.Fail(key, "expected two numbers, the lower one first");
  }
  range = {values[0], values[1]};
}

void DescribeSearch(config::Fields& f, GainSearchConfig* c) {
  f.NeedObject("search", "where the gains are sought", [&](config::Fields& g) {
    g.Need("trials", c->search.trials, {1, 1e6},
           "draws in each of the two stages, even in the logarithm");
    g("seed", c->search.seed, kNotNegative, "of the draws");
    DescribeRange(g, "proportional_Nm_rad", c->search.proportional, "stage 1, in all joints");
    DescribeRange(g, "integral_Nm_rad_s", c->search.integral, "stage 1");
    DescribeRange(g, "derivative_Nm_s_rad", c->search.derivative, "stage 1");
    DescribeRange(g, "around_best", c->search.around_best, "stage 2: factors of the best gains");
  });
  f.List("compare", {}, "run as well", [&](config::Fields& g) {
    auto& gains = c->compared.emplace_back();
    g.Need("name", gains.name, "in the tables");
    g.Need("proportional_Nm_rad", gains.proportional_Nm_rad, kPositive, "in all joints");
    g.Need("integral_Nm_rad_s", gains.integral_Nm_rad_s, kNotNegative, "in all joints");
    g.Need("derivative_Nm_s_rad", gains.derivative_Nm_s_rad, kNotNegative, "in all joints");
  });
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

void Describe(config::Fields& f, TuneFile& file) {
  DescribeTrial(f, &file.trial, &file.inputs);
  file.trial.robot = DescribeRobot(f, &file.inputs);
  file.trial.control = DescribeJoints(f, &file.inputs);
  file.control = file.inputs.at("control");
  DescribeSearch(f, &file.search);
  CheckFits(f, file.trial);
  for (const control::JointControlConfig& joint : file.trial.control) {
    f.Require(joint.strategy == control::Strategy::kPid, "control",
              "'" + file.control.string() + "' has a joint without PID, expected pid");
  }
  if (!file.trial.control.empty()) file.search.rest = file.trial.control.front().pid;
}

TuneFile LoadTune(const std::filesystem::path& path) {
  auto file = config::Read<TuneFile>(Section::Load(path, kTuneSchema));
  file.inputs["search"] = path;
  return file;
}

void Describe(config::Fields& f, PressureSweepConfig& sweep) {
  Inputs inputs;
  DescribeTrial(f, &sweep.elastic, &inputs);
  sweep.rigid = sweep.elastic;
  sweep.rigid.pneumatics.clear();
  const auto describe = [&](RobotTrialConfig* trial) {
    return [&inputs, trial](config::Fields& g) {
      trial->robot = DescribeRobot(g, &inputs);
      trial->control = DescribeJoints(g, &inputs);
      CheckFits(g, *trial);
    };
  };
  f.NeedObject("rigid", "without pressure", describe(&sweep.rigid));
  f.NeedObject("elastic", "its model has pneumatic_torque in some joints",
               describe(&sweep.elastic));
  f.Need("pressure_bar", sweep.pressure_bar, kNotNegative,
         "chamber and reservoir begin at it, the manager's target is it");
  f.Require(!sweep.elastic.pneumatics.empty(), "pneumatics", "is missing, expected a file");
}

PressureSweepConfig LoadPressureSweep(const std::filesystem::path& path) {
  return config::Read<PressureSweepConfig>(Section::Load(path, kSweepSchema));
}

std::string ControlText(const std::filesystem::path& control, const control::PidConfig& pid,
                        const std::filesystem::path& folder, const std::string& comment) {
  std::string text = config::ReadFile(control);
  while (!text.empty() && text.front() == '#') text.erase(0, text.find('\n') + 1);
  for (const Gain& gain : kGains) {
    if (ReplaceNumber(gain.key, pid.*gain.of, &text)) continue;
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
      config::Read<control::ControlConfig>(Section::Parse(text, name, "sinew-control/1"));
  for (const control::JointControlConfig& joint : read.joints) {
    if (SameGains(joint.pid, pid)) continue;
    throw UsageError(control.string() + ": its gains could not be replaced");
  }
  return text;
}

}  // namespace sinew::tune

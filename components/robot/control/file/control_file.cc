#include "components/robot/control/file/control_file.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <locale>
#include <map>
#include <sstream>

#include "components/base/types/joints.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::control {
namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

struct Units {
  bool linear = false;
  std::string Length(const std::string& stem) const { return stem + (linear ? "_m" : "_rad"); }
  std::string Velocity(const std::string& stem) const {
    return stem + (linear ? "_m_s" : "_rad_s");
  }
  std::string Acceleration(const std::string& stem) const {
    return stem + (linear ? "_m_s2" : "_rad_s2");
  }
  std::string Stiffness(const std::string& stem) const {
    return stem + (linear ? "_N_m" : "_Nm_rad");
  }
  std::string StiffnessRate(const std::string& stem) const {
    return stem + (linear ? "_N_m_s" : "_Nm_rad_s");
  }
  std::string Damping(const std::string& stem) const {
    return stem + (linear ? "_N_s_m" : "_Nm_s_rad");
  }
  std::string Torque(const std::string& stem) const { return stem + (linear ? "_N" : "_Nm"); }
};

template <class Enum>
Enum Word(const Section& s, std::string_view key, std::string_view fallback,
          const std::vector<std::pair<std::string, Enum>>& words) {
  std::vector<std::string> allowed;
  allowed.reserve(words.size());
  for (const auto& [word, value] : words) allowed.push_back(word);
  const std::string chosen = s.ChoiceOr(key, fallback, allowed);
  return std::find_if(words.begin(), words.end(), [&](const auto& w) { return w.first == chosen; })
      ->second;
}

PidConfig ReadPid(const Section& s, const Units& units) {
  PidConfig pid;
  pid.proportional_Nm_rad = s.Number(units.Stiffness("proportional"), kNotNegative);
  pid.integral_Nm_rad_s = s.NumberOr(units.StiffnessRate("integral"), 0.0, kNotNegative);
  pid.derivative_Nm_s_rad = s.NumberOr(units.Damping("derivative"), 0.0, kNotNegative);
  pid.derivative_filter_Hz = s.NumberOr("derivative_filter_Hz", 0.0, kNotNegative);
  pid.anti_windup_s = s.NumberOr("anti_windup_s", 0.1, kPositive);
  pid.integral_limit_Nm = s.NumberOr(units.Torque("integral_limit"), 0.0, kNotNegative);
  s.RejectUnknownKeys();
  return pid;
}

// CSV: a header line `time_s,motor_torque_Nm`, then rows at one period from time 0.
RecordedTorque ReadRecordedTorque(const Section& s) {
  const std::filesystem::path path = s.ExistingPath("recorded_torque");
  std::istringstream in(config::ReadFile(path, config::kLargestData));
  std::string line;
  long row = 0;
  const auto fail = [&](const std::string& what) {
    throw UsageError(path.string() + ":" + std::to_string(row) + ": " + what);
  };
  const auto next = [&] {
    ++row;
    return static_cast<bool>(std::getline(in, line));
  };
  if (!next() || line != "time_s,motor_torque_Nm") {
    fail("'" + line + "', expected the header time_s,motor_torque_Nm");
  }
  RecordedTorque recorded;
  std::vector<double> time_s;
  while (next()) {
    double at_s = 0.0, torque_Nm = 0.0;
    char comma = 0;
    std::istringstream text(line);
    text.imbue(std::locale::classic());
    if (!(text >> at_s >> comma >> torque_Nm) || comma != ',' || !(text >> std::ws).eof()) {
      fail("'" + line + "', expected two numbers");
    }
    time_s.push_back(at_s);
    recorded.motor_torque_Nm.push_back(torque_Nm);
  }
  if (time_s.size() < 2) fail("the table ends here, expected two rows at least");
  recorded.period_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  // A row may be written with few digits.
  const double same_s = 1e-3 * recorded.period_s;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    row = static_cast<long>(i) + 2;
    if (!(std::abs(time_s[i] - static_cast<double>(i) * recorded.period_s) <= same_s)) {
      fail("time_s " + std::to_string(time_s[i]) + ", expected rows at one period from 0 on");
    }
  }
  return recorded;
}

JointControlConfig ReadJoint(const Section& s, std::size_t index,
                             const std::filesystem::path& model_path) {
  JointControlConfig joint;
  joint.strategy = Word<Strategy>(s, "strategy", "pid",
                                  {{"position", Strategy::kPosition},
                                   {"pid", Strategy::kPid},
                                   {"pid_linear", Strategy::kPidLinear},
                                   {"pid_esn", Strategy::kPidEsn},
                                   {"computed_torque", Strategy::kComputedTorque}});

  // The drive: from the model file, or given here.
  Units units;
  double limit_Nm = 0.0;
  if (s.Has("model")) {
    if (s.Has("drive")) s.Fail("drive", "stands beside 'model', expected only one of them");
    const std::filesystem::path own = s.ExistingPath("model");
    const std::filesystem::path path = model_path.empty() ? own : model_path;
    const actuator::RobotModel robot = actuator::LoadRobotModel(path);
    std::size_t which = index;
    if (s.Has("model_joint")) {
      const std::string name = s.Text("model_joint");
      which = 0;
      while (which < robot.joints.size() && robot.joints[which].name != name) ++which;
      if (which == robot.joints.size()) {
        s.Fail("model_joint", "'" + name + "' is no joint of " + path.string());
      }
    }
    if (which >= robot.joints.size()) {
      s.Fail("model", path.string() + " has " + std::to_string(robot.joints.size()) +
                          " joints, expected one for joint " + std::to_string(index));
    }
    joint.model = robot.joints[which];
    units.linear = joint.model->kind == types::JointKind::kLinear;
    joint.gear_ratio = joint.model->constants.gear_ratio;
    limit_Nm = joint.model->motor_torque_limit_Nm;
    try {
      joint.shaft_per_output = ShaftPerOutput(*joint.model);
    } catch (const std::invalid_argument& error) {
      s.Fail("model", error.what());
    }
  } else if (joint.strategy != Strategy::kPosition || s.Has("drive")) {
    if (joint.strategy == Strategy::kPidLinear) {
      s.Fail("model", "is missing, expected the path of a model file for pid_linear");
    }
    const Section drive = s.Child("drive");
    units.linear = Word<bool>(drive, "kind", "rotary", {{"rotary", false}, {"linear", true}});
    joint.gear_ratio = drive.NumberOr("gear_ratio", 1.0, kPositive);
    joint.shaft_per_output =
        1.0 / (joint.gear_ratio * drive.NumberOr("efficiency", 1.0, kPositive));
    limit_Nm =
        drive.NumberOr(units.linear ? "force_limit_N" : "motor_torque_limit_Nm", 0.0, kPositive);
    drive.RejectUnknownKeys();
  }
  const std::string limit_key = units.linear ? "force_limit_N" : "motor_torque_limit_Nm";
  if (s.Has(limit_key)) {
    const double own_Nm = s.Number(limit_key, kPositive);
    if (limit_Nm > 0.0 && own_Nm > limit_Nm) {
      s.Fail(limit_key,
             "is above the drive's own limit, expected at most " + std::to_string(limit_Nm));
    }
    limit_Nm = own_Nm;
  }
  if (joint.strategy == Strategy::kPosition && limit_Nm == 0.0)
    limit_Nm = 1.0;  // never commands torque
  if (limit_Nm == 0.0) {
    s.Fail(limit_key, "is missing and the model states none, expected a number above 0");
  }
  joint.motor_torque_limit_Nm = limit_Nm;

  if (joint.strategy != Strategy::kPosition || s.Has("pid")) {
    joint.pid = ReadPid(s.Child("pid"), units);
    if (joint.strategy == Strategy::kComputedTorque && joint.pid.integral_Nm_rad_s > 0.0) {
      s.Fail("pid", "has an integral gain, expected none beside computed_torque (pid_esn has one)");
    }
  }
  joint.derivative_of = Word<DerivativeOf>(
      s, "derivative_of", "error",
      {{"error", DerivativeOf::kError}, {"measurement", DerivativeOf::kMeasurement}});
  joint.velocity_from =
      Word<VelocityFrom>(s, "velocity_from", "output",
                         {{"motor", VelocityFrom::kMotor},
                          {"output", VelocityFrom::kOutput},
                          {"output_difference", VelocityFrom::kOutputDifference}});
  if (joint.strategy == Strategy::kPidLinear) {
    joint.compensator.kind = Word<CompensatorKind>(s, "compensate", "model",
                                                   {{"linear", CompensatorKind::kLinear},
                                                    {"model", CompensatorKind::kModel},
                                                    {"recorded", CompensatorKind::kRecorded}});
    if (joint.compensator.kind == CompensatorKind::kRecorded) {
      joint.compensator.recorded = ReadRecordedTorque(s);
    }
    joint.compensator.smoothing_rad_s =
        s.NumberOr(units.Velocity("smoothing"), joint.compensator.smoothing_rad_s, kNotNegative);
    joint.compensator.pressure_filter_Hz =
        s.NumberOr("pressure_filter_Hz", joint.compensator.pressure_filter_Hz, kNotNegative);
    joint.compensator.lead_s = s.NumberOr("lead_s", joint.compensator.lead_s, {0.0, 0.1});
  }
  if (joint.strategy == Strategy::kPidEsn) joint.by_regime = s.BoolOr("by_regime", true);
  joint.takeover_s = s.NumberOr("takeover_s", joint.takeover_s, kNotNegative);
  joint.replay_takeover_s = s.NumberOr("replay_takeover_s", joint.replay_takeover_s, kNotNegative);
  joint.crossfade_s = s.NumberOr("crossfade_s", joint.crossfade_s, kNotNegative);
  joint.tracking_error_limit_rad =
      s.NumberOr(units.Length("tracking_error_limit"),
                 units.linear ? kTrackingErrorLimit_m : kTrackingErrorLimit_rad, kNotNegative);
  joint.damping_Nm_s_rad =
      s.NumberOr(units.Damping("safe_damping"), joint.damping_Nm_s_rad, kNotNegative);
  joint.on_stale =
      Word<OnStale>(s, "on_stale", "hold", {{"hold", OnStale::kHold}, {"damp", OnStale::kDamp}});
  joint.stale_grace_s = s.NumberOr("stale_grace_s", joint.stale_grace_s, {0.0, 0.2});
  joint.motion_acceleration_rad_s2 = s.NumberOr(units.Acceleration("motion_acceleration"),
                                                joint.motion_acceleration_rad_s2, kPositive);
  s.RejectUnknownKeys();
  return joint;
}

}  // namespace

bool ControlConfig::needs_prediction() const {
  return std::any_of(joints.begin(), joints.end(), [](const JointControlConfig& joint) {
    return UsesPrediction(joint.strategy);
  });
}

bool ControlConfig::needs_regime() const {
  return std::any_of(joints.begin(), joints.end(),
                     [](const JointControlConfig& joint) { return joint.needs_regime(); });
}

ControlConfig ReadControl(const config::Section& section, const std::filesystem::path& model_path) {
  ControlConfig control;
  control.motion_requests = Word<MotionRequests>(section, "motion_requests", "off",
                                                 {{"off", MotionRequests::kOff},
                                                  {"optional", MotionRequests::kOptional},
                                                  {"every_tick", MotionRequests::kEveryTick}});
  control.motion_timeout_s =
      section.NumberOr("motion_timeout_s", control.motion_timeout_s, kPositive);
  const std::vector<Section> joints = section.List("joints");
  if (joints.empty() || joints.size() > static_cast<std::size_t>(types::kMaxJoints)) {
    section.Fail("joints", "has " + std::to_string(joints.size()) + " entries, expected 1 to " +
                               std::to_string(types::kMaxJoints));
  }
  for (std::size_t j = 0; j < joints.size(); ++j)
    control.joints.push_back(ReadJoint(joints[j], j, model_path));
  control.joint_names = section.TextsOr("joint_names", {});
  if (!control.joint_names.empty() && control.joint_names.size() != joints.size()) {
    section.Fail("joint_names", "has " + std::to_string(control.joint_names.size()) +
                                    " entries, expected as many as joints, " +
                                    std::to_string(joints.size()));
  }
  section.RejectUnknownKeys();
  return control;
}

ControlConfig LoadControl(const std::filesystem::path& path,
                          const std::filesystem::path& model_path) {
  return ReadControl(Section::Load(path, "sinew-control/1"), model_path);
}

}  // namespace sinew::control

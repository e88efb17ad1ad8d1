#include "components/robot/control/file/control_file.h"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>

#include "components/base/types/joints.h"
#include "components/model/actuator/file/model_file.h"

namespace sinew::control {
using config::kNotNegative;
using config::kPositive;

static void Describe(config::Fields& f, PidConfig& c) {
  f.Need("~proportional_Nm_rad", c.proportional_Nm_rad, kNotNegative, "at the output");
  f("~integral_Nm_rad_s", c.integral_Nm_rad_s, kNotNegative, "0: none");
  f("~derivative_Nm_s_rad", c.derivative_Nm_s_rad, kNotNegative, "0: none");
  f("derivative_filter_Hz", c.derivative_filter_Hz, kNotNegative, "low-pass; 0: none");
  f("anti_windup_s", c.anti_windup_s, kPositive, "of back-calculation at the torque limit");
  f("~integral_limit_Nm", c.integral_limit_Nm, kNotNegative, "of the integral part; 0: none");
}

// CSV: a header line `time_s,motor_torque_Nm`, then rows at one period from time 0.
static RecordedTorque ReadRecordedTorque(const std::filesystem::path& path) {
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

// The joint's place in the robot. Throws std::invalid_argument.
static const actuator::JointModel& JointOf(const actuator::RobotModel& robot,
                                           const std::string& name, std::size_t index,
                                           const std::string& path) {
  for (const actuator::JointModel& joint : robot.joints) {
    if (joint.name == name) return joint;
  }
  if (!name.empty()) throw std::invalid_argument("'" + name + "' is no joint of " + path);
  if (index < robot.joints.size()) return robot.joints[index];
  throw std::invalid_argument(path + " has " + std::to_string(robot.joints.size()) +
                              " joints, expected one for joint " + std::to_string(index));
}

// Sets the drive, from the model file or given here; returns the limit of its torque, 0: none.
static double DescribeDrive(config::Fields& f, const std::filesystem::path& model_path,
                            std::size_t index, JointControlConfig* joint) {
  std::optional<std::filesystem::path> own;
  std::string model_joint;
  double limit_Nm = 0.0;
  bool linear = false;
  f("model", own, "model file with the drive; needed by pid_linear");
  f("model_joint", model_joint, "its joint in the model; left out: at the same place");
  const bool given = f.If("drive", "in place of a model", [&](config::Fields& drive) {
    double efficiency = 1.0;
    std::optional<double> limit;
    drive.Word("kind", linear, {{"rotary", false}, {"linear", true}}, "rad and Nm, or m and N");
    drive("gear_ratio", joint->gear_ratio, kPositive, "motor turns per output turn");
    drive("efficiency", efficiency, kPositive, "of gear and motor");
    joint->shaft_per_output = 1.0 / (joint->gear_ratio * efficiency);
    if (!linear) drive("motor_torque_limit_Nm", limit, kPositive, "at the motor shaft");
    if (linear || !drive.reads()) drive("force_limit_N", limit, kPositive, "of a linear joint");
    limit_Nm = limit.value_or(0.0);
  });
  if (!model_joint.empty() && !own) f.Fail("model_joint", "without 'model', expected both or none");
  if (f.reads() && given && own)
    f.Fail("drive", "stands beside 'model', expected only one of them");
  if (own) {
    const std::filesystem::path path = model_path.empty() ? *own : model_path;
    try {
      joint->model = JointOf(actuator::LoadRobotModel(path), model_joint, index, path.string());
      joint->shaft_per_output = ShaftPerOutput(*joint->model);
    } catch (const std::invalid_argument& error) {
      f.Fail(model_joint.empty() ? "model" : "model_joint", error.what());
    }
    linear = joint->model->kind == types::JointKind::kPrismatic;
    joint->gear_ratio = joint->model->constants.gear_ratio;
    limit_Nm = joint->model->motor_torque_limit_Nm;
  } else if (joint->strategy == Strategy::kPidLinear) {
    f.Fail("model", "is missing, expected the path of a model file for pid_linear");
  } else if (joint->strategy != Strategy::kPosition && !given) {
    f.Fail("drive", "missing, expected a mapping");
  }
  f.set_linear(linear);
  return limit_Nm;
}

// Sets the limit of the motor's torque: the drive's, or an own one below it.
static void DescribeLimit(config::Fields& f, double drive_Nm, bool linear,
                          JointControlConfig* joint) {
  const char* key = linear ? "force_limit_N" : "motor_torque_limit_Nm";
  std::optional<double> own_Nm;
  f(key, own_Nm, kPositive, "below that of the drive");
  if (!f.reads()) f("force_limit_N", own_Nm, kPositive, "the same of a linear joint");
  if (own_Nm && drive_Nm > 0.0 && *own_Nm > drive_Nm) {
    f.Fail(key, "is above the drive's own limit, expected at most " + std::to_string(drive_Nm));
  }
  double limit_Nm = own_Nm.value_or(drive_Nm);
  if (joint->strategy == Strategy::kPosition && limit_Nm == 0.0) {
    limit_Nm = 1.0;  // never commands torque
  }
  if (f.reads() && limit_Nm == 0.0) {
    f.Fail(key, "is missing and the model states none, expected a number above 0");
  }
  joint->motor_torque_limit_Nm = limit_Nm;
}

static void Describe(config::Fields& f, CompensatorConfig& c) {
  c.kind = CompensatorKind::kModel;
  const auto kind = f.Word("compensate", c.kind,
                           {{"linear", CompensatorKind::kLinear},
                            {"model", CompensatorKind::kModel},
                            {"recorded", CompensatorKind::kRecorded}},
                           "by the linear terms, the whole model, or a recording");
  if (const auto recorded = kind.Is({"recorded"})) {
    std::filesystem::path path;
    f.Need("recorded_torque", path, "CSV with columns time_s,motor_torque_Nm");
    if (f.reads()) c.recorded = ReadRecordedTorque(path);
  }
  f("~smoothing_rad_s", c.smoothing_rad_s, kNotNegative, "of the sign of the speed");
  f("pressure_filter_Hz", c.pressure_filter_Hz, kNotNegative,
    "measured pressure and load force are smoothed; 0: as they are");
  f("lead_s", c.lead_s, {0.0, 0.1}, "the reference this much later: delay of the drive");
}

static void DescribeRest(config::Fields& f, JointControlConfig& joint) {
  f("takeover_s", joint.takeover_s, kNotNegative, "from one generator's reference to another's");
  f("replay_takeover_s", joint.replay_takeover_s, kNotNegative,
    "the same where a permitted recording begins to move live hardware");
  f("crossfade_s", joint.crossfade_s, kNotNegative, "between the networks of two regimes");
  joint.tracking_error_limit_rad = f.linear() ? kTrackingErrorLimit_m : kTrackingErrorLimit_rad;
  f("~tracking_error_limit_rad", joint.tracking_error_limit_rad, kNotNegative,
    "farther from the reference: a fault; 0: none");
  f("~safe_damping_Nm_s_rad", joint.damping_Nm_s_rad, kNotNegative, "of a damped joint");
  f.Word("on_stale", joint.on_stale, {{"hold", OnStale::kHold}, {"damp", OnStale::kDamp}},
         "without fresh samples");
  f("stale_grace_s", joint.stale_grace_s, {0.0, 0.2}, "what a standby needs to take over");
  f("~motion_acceleration_rad_s2", joint.motion_acceleration_rad_s2, kPositive,
    "of motion that others ask for");
}

static void DescribeJoint(config::Fields& f, const std::filesystem::path& model_path,
                          std::vector<JointControlConfig>* joints) {
  JointControlConfig& joint = joints->emplace_back();
  const auto strategy = f.Word("strategy", joint.strategy,
                               {{"position", Strategy::kPosition},
                                {"pid", Strategy::kPid},
                                {"pid_linear", Strategy::kPidLinear},
                                {"pid_esn", Strategy::kPidEsn},
                                {"computed_torque", Strategy::kComputedTorque}},
                               "the reference as it is, PID, or PID and a prediction");
  const double drive_Nm = DescribeDrive(f, model_path, joints->size() - 1, &joint);
  DescribeLimit(f, drive_Nm, f.linear(), &joint);
  if (!f.If("pid", "gains; needed except by position",
            [&](config::Fields& pid) { Describe(pid, joint.pid); }) &&
      joint.strategy != Strategy::kPosition) {
    f.Fail("pid", "missing, expected a mapping");
  }
  if (joint.strategy == Strategy::kComputedTorque && joint.pid.integral_Nm_rad_s > 0.0) {
    f.Fail("pid", "has an integral gain, expected none beside computed_torque (pid_esn has one)");
  }
  f.Word("derivative_of", joint.derivative_of,
         {{"error", DerivativeOf::kError}, {"measurement", DerivativeOf::kMeasurement}},
         "the D part");
  f.Word("velocity_from", joint.velocity_from,
         {{"motor", VelocityFrom::kMotor},
          {"output", VelocityFrom::kOutput},
          {"output_difference", VelocityFrom::kOutputDifference}},
         "for the D part");
  if (const auto compensated = strategy.Is({"pid_linear"})) Describe(f, joint.compensator);
  if (const auto predicted = strategy.Is({"pid_esn"})) {
    f("by_regime", joint.by_regime, "networks by the regime inside and outside of the backlash");
  }
  DescribeRest(f, joint);
}

void Describe(config::Fields& f, ControlConfig& c, const std::filesystem::path& model_path) {
  f.Word("motion_requests", c.motion_requests,
         {{"off", MotionRequests::kOff},
          {"optional", MotionRequests::kOptional},
          {"every_tick", MotionRequests::kEveryTick}},
         "not read; read when they come; awaited in every tick");
  f("motion_timeout_s", c.motion_timeout_s, kPositive, "an older request has ended");
  f.NeedList("joints", {1, types::kMaxJoints}, "in the order of joint_state",
             [&](config::Fields& joint) { DescribeJoint(joint, model_path, &c.joints); });
  f("joint_names", c.joint_names, "the robot's, compared before anybody arms; left out: not");
  if (!c.joint_names.empty() && c.joint_names.size() != c.joints.size()) {
    f.Fail("joint_names", "has " + std::to_string(c.joint_names.size()) +
                              " entries, expected as many as joints, " +
                              std::to_string(c.joints.size()));
  }
}

bool ControlConfig::needs_prediction() const {
  return std::any_of(joints.begin(), joints.end(), [](const JointControlConfig& joint) {
    return UsesPrediction(joint.strategy);
  });
}

bool ControlConfig::needs_regime() const {
  return std::any_of(joints.begin(), joints.end(),
                     [](const JointControlConfig& joint) { return joint.needs_regime(); });
}

ControlConfig LoadControl(const std::filesystem::path& path,
                          const std::filesystem::path& model_path) {
  return config::Read<ControlConfig>(config::Section::Load(path, kSchema), model_path);
}

}  // namespace sinew::control

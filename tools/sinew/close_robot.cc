#include "tools/sinew/close_robot.h"

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <numeric>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/payloads/payloads.h"
#include "components/model/report/gate_page.h"
#include "components/model/report/section.h"
#include "components/model/trace/close_loop.h"
#include "tools/sinew/find_urdf.h"

namespace sinew::tools {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json ErrorJson(const arm::ArmError& error) {
  return {{"nrms_percent", error.nrms_percent},
          {"relative_percent", error.all_relative_percent},
          {"joints_rms", error.rms_Nm},
          {"joints_relative_percent", error.relative_percent}};
}

Json LoadJson(const std::optional<arm::LoadOnLink>& load) {
  if (!load) return nullptr;
  return {{"link", load->link},
          {"mass_kg", load->mass_kg},
          {"mass_half_width_95_kg", load->half_width_95},
          {"position_m", std::vector<double>(load->position_m.begin(), load->position_m.end())},
          {"share", load->share}};
}

Json ArmJson(const arm::ArmLoop& loop) {
  Json base = Json::array();
  for (std::size_t i = 0; i < loop.before.base.size(); ++i) {
    const arm::BaseParameter& before = loop.before.base[i];
    const arm::BaseParameter& after = loop.after.base[i];
    base.push_back({{"name", before.name},
                    {"nominal", before.nominal},
                    {"before", before.value},
                    {"before_half_width_95", before.half_width_95},
                    {"after", after.value},
                    {"after_half_width_95", after.half_width_95}});
  }
  return {
      {"train", {{"before", ErrorJson(loop.before.train)}, {"after", ErrorJson(loop.after.train)}}},
      {"held_out",
       {{"nominal", ErrorJson(loop.held_out_nominal)},
        {"before", ErrorJson(loop.held_out_before)},
        {"after", ErrorJson(loop.held_out_after)}}},
      {"load", LoadJson(loop.load)},
      {"held_out_load", LoadJson(loop.held_out_load)},
      {"base_parameters", base}};
}

std::string LoadText(const arm::LoadOnLink& load) {
  using report::Short;
  return (load.mass_kg < 0.0 ? "a mass taken from link '" : "a mass on link '") + load.link +
         "': " + Short(std::abs(load.mass_kg)) + " +- " + Short(load.half_width_95) + " kg at (" +
         Short(load.position_m.x()) + ", " + Short(load.position_m.y()) + ", " +
         Short(load.position_m.z()) + ") m of its frame";
}

// The robot's verdict is that of the joint with the largest.
std::size_t Weight(const std::string& verdict) {
  static const std::vector<std::string> kRising = {"none", "too_little_data", "unexplained",
                                                   "effect", "data_fault"};
  return static_cast<std::size_t>(std::find(kRising.begin(), kRising.end(), verdict) -
                                  kRising.begin());
}

std::string RobotJson(const CloseRobotResult& result) {
  Json out;
  std::string verdict = "none";
  Json joints = Json::array();
  for (std::size_t i = 0; i < result.joints.size(); ++i) {
    Json joint = Json::parse(result.joints[i].json);
    const std::string one = joint["verdict"];
    if (Weight(one) > Weight(verdict)) verdict = one;
    Json entry;
    entry["joint"] =
        result.model.robot.joints[static_cast<std::size_t>(result.joint_numbers[i])].name;
    entry.update(joint);
    joints.push_back(std::move(entry));
  }
  out["robot"] = result.model.robot.name;
  out["verdict"] = verdict;
  if (result.arm) out["arm"] = ArmJson(*result.arm);
  out["joints"] = std::move(joints);
  return types::JsonText(out, 2) + "\n";
}

bool AnyStops(const std::vector<gate::GateReport>& reports) {
  return std::any_of(reports.begin(), reports.end(),
                     [](const gate::GateReport& report) { return report.stops(); });
}

// The joints of an arm share their rows: each reports those that another one leaves out, too.
void NameRowsOfOthers(const actuator::RobotModel& robot, std::vector<gate::GateReport>* reports) {
  std::vector<std::vector<identify::Finding>> more(reports->size());
  for (std::size_t j = 0; j < reports->size(); ++j) {
    for (const identify::Finding& finding : (*reports)[j].findings) {
      if (finding.name != gate::kLeftOutRows) continue;
      for (std::size_t other = 0; other < reports->size(); ++other) {
        if (other == j) continue;
        more[other].push_back(finding);
        more[other].back().text =
            "joint '" + robot.joints[j].name + "': " + more[other].back().text;
      }
    }
  }
  for (std::size_t j = 0; j < reports->size(); ++j) {
    std::vector<identify::Finding>& findings = (*reports)[j].findings;
    findings.insert(findings.end(), more[j].begin(), more[j].end());
  }
}

// What the data gate finds on each joint of an arm. Where no joint stops, the recordings of all go
// on without the rows that one of them leaves out.
std::vector<gate::GateReport> ExamineArm(const CloseLoopOptions& options,
                                         const actuator::RobotModel& robot, arm::ArmRuns* train,
                                         arm::ArmRuns* held_out) {
  const bool rotates = options.held_out.empty();
  std::vector<gate::GateReport> out;
  std::vector<gate::LeftOut> left_out;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    std::vector<types::Run> runs = (*train)[j];
    if (!rotates) runs.insert(runs.end(), (*held_out)[j].begin(), (*held_out)[j].end());
    out.push_back(AskGate(options, runs, robot.joints[j]));
    left_out.insert(left_out.end(), out[j].left_out.begin(), out[j].left_out.end());
  }
  if (AnyStops(out)) return out;
  NameRowsOfOthers(robot, &out);
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    std::vector<types::Run> none;
    LeaveOutRows(left_out, &(*train)[j], rotates ? &none : &(*held_out)[j]);
    if (rotates) (*held_out)[j] = (*train)[j];
  }
  return out;
}

// An arm is fitted with all of its joints. Where one has a fault, the report of each other one
// names it: nothing is known of their rigid bodies, so none of them can be traced.
void NameFaultsOfOthers(const actuator::RobotModel& robot, std::vector<gate::GateReport>* reports) {
  std::vector<gate::Fault> faults;
  for (std::size_t j = 0; j < reports->size(); ++j) {
    for (const gate::Fault& fault : (*reports)[j].faults) {
      if (fault.accepted) continue;
      gate::Fault of_other = fault;
      of_other.signal +=
          (fault.signal.empty() ? "joint '" : " of joint '") + robot.joints[j].name + "'";
      of_other.reason +=
          " Because of it the arm was not fitted and this joint, whose own data do not stop, is "
          "not "
          "assessed.";
      faults.push_back(std::move(of_other));
    }
  }
  for (gate::GateReport& report : *reports) {
    if (report.stops()) continue;
    report.faults.insert(report.faults.end(), faults.begin(), faults.end());
  }
}

// An arm's recordings, one held out.
struct ArmFold {
  arm::ArmRuns train, held_out;  // with the rigid torques of this fold's fit
  arm::ArmLoop loop;
};

std::vector<ArmFold> LeaveOneOut(const arm::Arm& arm, const actuator::RobotModel& robot,
                                 const identify::ProcessingOptions& wished,
                                 const arm::ArmRuns& runs) {
  std::vector<ArmFold> out;
  for (std::size_t i = 0; i < runs.front().size(); ++i) {
    ArmFold fold;
    for (std::size_t j = 0; j < runs.size(); ++j) {
      trace::Fold of_joint = trace::LeaveOneOut(runs[j], robot.joints[j]).at(i);
      fold.train.push_back(std::move(of_joint.train));
      fold.held_out.push_back({std::move(of_joint.held_out)});
    }
    fold.loop = arm::FitArm(arm, robot, wished, &fold.train, &fold.held_out);
    out.push_back(std::move(fold));
  }
  return out;
}

// What joint j's own rotation is asked. The folds outlive it.
std::vector<trace::Fold> FoldsOfJoint(const arm::Arm& arm, std::vector<ArmFold>& folds,
                                      std::size_t j) {
  std::vector<trace::Fold> out;
  out.reserve(folds.size());
  for (ArmFold& fold : folds) {
    out.push_back({fold.train[j], fold.held_out[j].front(), fold.loop.before.robot.joints[j],
                   [&arm, &fold, j](const actuator::JointModel& joint) {
                     actuator::RobotModel with = fold.loop.before.robot;
                     with.joints[j] = joint;
                     return arm::HeldOutError(arm, with, fold.train, fold.held_out,
                                              fold.loop.processing);
                   }});
  }
  return out;
}

// Held-out errors of the whole arm from its rotations, each with what that rotation found.
void PoolFolds(const arm::Arm& arm, const std::vector<CloseLoopResult>& joints,
               const std::vector<int>& joint_numbers, std::vector<ArmFold>* folds,
               arm::ArmLoop* all) {
  std::vector<arm::ArmError> nominal, before, after;
  std::vector<double> rows;
  for (std::size_t i = 0; i < folds->size(); ++i) {
    ArmFold& fold = (*folds)[i];
    actuator::RobotModel corrected = fold.loop.before.robot;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const std::vector<trace::Rotation>& rotations = joints[k].report.rotations;
      if (i < rotations.size()) {
        corrected.joints[static_cast<std::size_t>(joint_numbers[k])] = rotations[i].trace.corrected;
      }
    }
    arm::FinishArm(arm, corrected, fold.train, fold.held_out, &fold.loop);
    nominal.push_back(fold.loop.held_out_nominal);
    before.push_back(fold.loop.held_out_before);
    after.push_back(fold.loop.held_out_after);
    rows.push_back(static_cast<double>(fold.held_out.front().front().size()));
  }
  all->held_out_nominal = arm::Pooled(nominal, rows);
  all->held_out_before = arm::Pooled(before, rows);
  all->held_out_after = arm::Pooled(after, rows);
}

}  // namespace

std::filesystem::path FindUrdf(const CloseLoopOptions& options, const LoopInput& input) {
  std::filesystem::path wanted =
      options.urdf.empty() ? std::filesystem::path(input.model.robot.urdf_path) : options.urdf;
  if (wanted.empty()) {
    throw UsageError(
        input.model_path.string() +
        ": joints with a term rigid_body, and a robot on two feet, need the robot's URDF, expected "
        "'urdf' in the model file or --urdf");
  }
  std::filesystem::path beside = input.model_path.parent_path() / wanted;
  if (wanted.is_relative() && std::filesystem::exists(beside)) return beside;
  if (!std::filesystem::exists(wanted)) {
    throw UsageError(wanted.string() + ": no such file, expected the robot's URDF");
  }
  return wanted;
}

CloseRobotResult CloseRobot(const CloseLoopOptions& options, std::vector<int> joints) {
  LoopInput input = LoadLoopInput(options);
  actuator::RobotModel& robot = input.model.robot;
  if (joints.empty()) {
    joints.resize(robot.joints.size());
    std::iota(joints.begin(), joints.end(), 0);
  }
  CloseRobotResult out;
  out.joint_numbers = joints;
  RequireOtherRows(options.train, options.held_out);
  if (options.progress) options.progress("reading recordings", 0.0);
  // Without any, each recording is held out once, and the last fit is to all of them.
  const bool rotates = options.held_out.empty();
  arm::ArmRuns train, held_out;
  bool is_arm = false;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    train.push_back(ReadJoint(options.train, input.map, static_cast<int>(j)));
    held_out.push_back(rotates
                           ? train.back()
                           : ReadJoint(options.held_out, input.held_out_map, static_cast<int>(j)));
    is_arm = is_arm || robot.joints[j].Find("rigid_body") >= 0;
  }
  std::vector<gate::GateReport> gates;  // of an arm's joints
  if (is_arm) gates = ExamineArm(options, robot, &train, &held_out);
  const bool stopped = AnyStops(gates);
  if (stopped) NameFaultsOfOthers(robot, &gates);
  std::optional<arm::Arm> arm;
  std::vector<ArmFold> folds;
  try {
    if (rotates) {
      RequireRotation(options, train.front());
    } else {
      trace::RequireHeldOut(train.front(), held_out.front());
    }
    if (is_arm && !stopped) {
      const fs::path urdf = FindUrdf(options, input);
      arm.emplace(
          arm::WithPayloads(arm::ParseUrdf(config::ReadFile(urdf), urdf.string()), robot.payloads),
          robot);
      const identify::ProcessingOptions wished =
          identify::ReadProcessing(input.model.root, robot.joints[0].kind);
      if (rotates) folds = LeaveOneOut(*arm, robot, wished, train);
      out.arm = arm::FitArm(*arm, robot, wished, &train, &held_out);
      out.arm->load = arm::AbsorbedLoad(*arm, out.arm->before);
      if (!rotates) out.arm->held_out_load = arm::LoadHeldOut(*arm, robot, *out.arm, held_out);
      robot = out.arm->before.robot;
    }
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
  out.model = input.model;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    CloseLoopOptions one = options;
    one.joint = joints[i];
    one.searches = static_cast<int>(joints.size());
    if (options.progress) {
      one.progress = [&](const std::string& what, double share) {
        options.progress(what,
                         (static_cast<double>(i) + share) / static_cast<double>(joints.size()));
      };
    }
    const auto j = static_cast<std::size_t>(joints[i]);
    if (is_arm) one.gate = gates[j];
    if (arm) {
      one.held_out_error = [&](const actuator::JointModel& joint) {
        actuator::RobotModel with = out.model.robot;
        with.joints[j] = joint;
        return arm::HeldOutError(*arm, with, train, held_out, out.arm->processing);
      };
      one.folds = FoldsOfJoint(*arm, folds, j);
    }
    out.joints.push_back(
        CloseLoopOn(one, input, train[j], rotates ? std::vector<types::Run>{} : held_out[j]));
    out.model.robot.joints[j] = out.joints.back().model.robot.joints[j];
  }
  if (arm) {
    try {
      arm::FinishArm(*arm, out.model.robot, train, held_out, &*out.arm);
      if (rotates) PoolFolds(*arm, out.joints, joints, &folds, &*out.arm);
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
    out.model.robot = out.arm->after.robot;
  }
  out.json = RobotJson(out);
  if (options.out.empty()) return out;
  MakeFolder(options.out);
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const fs::path folder =
        options.out / out.model.robot.joints[static_cast<std::size_t>(joints[i])].name;
    MakeFolder(folder);
    config::WriteFileAtomically(folder / "report.json", out.joints[i].json);
    config::WriteFileAtomically(folder / "report.html", out.joints[i].html);
  }
  if (!stopped) actuator::SaveModelFile(options.out / "model.yaml", out.model);
  config::WriteFileAtomically(options.out / "report.json", out.json);
  return out;
}

void PrintSummary(const CloseRobotResult& result, const CloseLoopOptions& options) {
  using report::Short;
  for (std::size_t i = 0; i < result.joints.size(); ++i) {
    const CloseLoopResult& joint = result.joints[i];
    PrintGate(joint.gate);
    std::cout << result.model.robot.joints[static_cast<std::size_t>(result.joint_numbers[i])].name
              << ": "
              << (joint.gate.stops() ? report::VerdictSentence(joint.gate)
                                     : report::VerdictSentence(joint.report))
              << '\n';
  }
  if (result.arm) {
    const arm::ArmLoop& loop = *result.arm;
    std::cout << "arm, held-out: " << Short(loop.held_out_nominal.all_relative_percent)
              << " % as declared, " << Short(loop.held_out_before.all_relative_percent)
              << " % refitted, " << Short(loop.held_out_after.all_relative_percent)
              << " % with the effects; rms over twice the effort limit "
              << Short(loop.held_out_nominal.nrms_percent) << " -> "
              << Short(loop.held_out_before.nrms_percent) << " -> "
              << Short(loop.held_out_after.nrms_percent) << " % (" << loop.before.base.size()
              << " base parameters)\n";
    if (loop.load) {
      std::cout << "arm: " << Short(100.0 * loop.load->share)
                << " % of what the refit of the bodies changes is " << LoadText(*loop.load) << '\n';
    }
    if (loop.held_out_load) {
      std::cout << "arm, held-out: those recordings differ from the training ones by "
                << LoadText(*loop.held_out_load)
                << ". Declare it there, else the size of no effect can be confirmed\n";
    }
  }
  std::cout << "written: " << (options.out / "report.json").string()
            << (fs::exists(options.out / "model.yaml") ? ", model.yaml" : "")
            << ", and a report of each joint in a folder of its name\n";
}

}  // namespace sinew::tools

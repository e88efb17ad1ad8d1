#include <algorithm>
#include <nlohmann/json.hpp>
#include <numeric>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/model/close_loop/builders.h"
#include "components/model/identify/file/processing_file.h"
#include "components/model/report/file/report_file.h"

namespace sinew::close_loop {

namespace {

bool AnyStops(const std::vector<gate::GateReport>& reports) {
  return std::any_of(reports.begin(), reports.end(),
                     [](const gate::GateReport& report) { return report.stops(); });
}

// The joints of an arm share their rows and are fitted together. Where one has a fault, the report
// of each other one names it: nothing is known of their rigid bodies, so none of them can be
// traced. Else each reports the rows that another one leaves out, too.
void NameThoseOfOthers(const actuator::RobotModel& robot, std::vector<gate::GateReport>* reports) {
  const std::vector<gate::GateReport> own = *reports;
  const bool stopped = AnyStops(own);
  for (std::size_t other = 0; other < own.size(); ++other) {
    gate::GateReport& to = (*reports)[other];
    for (std::size_t j = 0; j < own.size(); ++j) {
      if (j == other || own[other].stops()) continue;
      const std::string joint = "joint '" + robot.joints[j].name + "'";
      for (gate::Fault fault : own[j].faults) {
        if (fault.accepted) continue;
        fault.signal += (fault.signal.empty() ? "" : " of ") + joint;
        fault.reason +=
            " Because of it the arm was not fitted and this joint, whose own data do not stop, is "
            "not assessed.";
        to.faults.push_back(std::move(fault));
      }
      for (gate::Finding finding : own[j].findings) {
        if (stopped || finding.name != gate::kLeftOutRows) continue;
        finding.text = joint + ": " + finding.text;
        to.findings.push_back(std::move(finding));
      }
    }
  }
}

// Results of the data gate on each joint of an arm. Where no joint stops, the recordings of all go
// on without the rows that one of them leaves out.
std::vector<gate::GateReport> ExamineArm(const Options& options, const actuator::RobotModel& robot,
                                         arm::ArmRuns* train, arm::ArmRuns* held_out) {
  std::vector<gate::GateReport> out;
  std::vector<gate::LeftOut> left_out;
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    out.push_back(AskGate(options, Together((*train)[j], (*held_out)[j]), robot.joints[j]));
    left_out.insert(left_out.end(), out[j].left_out.begin(), out[j].left_out.end());
  }
  const bool stopped = AnyStops(out);
  NameThoseOfOthers(robot, &out);
  for (std::size_t j = 0; !stopped && j < robot.joints.size(); ++j) {
    LeaveOutRows(left_out, &(*train)[j], &(*held_out)[j]);
  }
  return out;
}

// An arm's recordings, one held out.
struct ArmFold {
  arm::ArmRuns train, held_out;  // with the rigid torques of this fold's fit
  arm::ArmLoop loop;
};

// An arm whose rigid bodies were fitted with the friction of all joints.
class FittedArm {
 public:
  // train and held_out get the rigid torques; held_out as `train` where each is held out once. The
  // joints of `robot` get the fitted friction, `loop` the errors.
  FittedArm(const Options& options, const Input& input, arm::ArmRuns* train, arm::ArmRuns* held_out,
            actuator::RobotModel* robot, arm::ArmLoop* loop)
      : arm_(BodiesOf(options, input), *robot), train_(*train), held_out_(*held_out), loop_(*loop) {
    const identify::ProcessingOptions wished =
        identify::ReadProcessing(input.model.root, robot->joints[0].kind);
    const bool rotates = options.held_out.empty();
    if (rotates) LeaveOneOut(*robot, wished);
    *loop = arm::FitArm(arm_, *robot, wished, train, held_out);
    loop->load = arm::AbsorbedLoad(arm_, loop->before);
    if (!rotates) loop->held_out_load = arm::LoadHeldOut(arm_, *robot, *loop, *held_out);
    *robot = loop->before.robot;
  }

  // Sets what joint j is asked beside its own residual; robot: as corrected so far, lives longer.
  void Ask(std::size_t j, const actuator::RobotModel& robot, JointTask* task) {
    const auto error_of = [this, j](const actuator::RobotModel& others, const arm::ArmRuns& train,
                                    const arm::ArmRuns& held_out, const arm::ArmLoop& loop) {
      return [this, j, &others, &train, &held_out, &loop](const actuator::JointModel& joint) {
        actuator::RobotModel with = others;
        with.joints[j] = joint;
        return arm::HeldOutError(arm_, with, train, held_out, loop.processing);
      };
    };
    task->held_out_error = error_of(robot, train_, held_out_, loop_);
    for (const ArmFold& fold : folds_) {
      const actuator::RobotModel& fitted = fold.loop.before.robot;
      task->folds.push_back({fold.train[j], fold.held_out[j].front(), fitted.joints[j],
                             error_of(fitted, fold.train, fold.held_out, fold.loop)});
    }
  }

  // All together again with what was found; from its rotations where each was held out once.
  void Finish(const std::vector<int>& numbers, const std::vector<report::Report>& reports,
              actuator::RobotModel* robot) {
    arm::FinishArm(arm_, *robot, train_, held_out_, &loop_);
    *robot = loop_.after.robot;
    if (folds_.empty()) return;
    std::vector<arm::ArmError> nominal, before, after;
    std::vector<double> rows;
    for (std::size_t i = 0; i < folds_.size(); ++i) {
      ArmFold& fold = folds_[i];
      actuator::RobotModel corrected = fold.loop.before.robot;
      for (std::size_t k = 0; k < reports.size(); ++k) {
        const std::vector<trace::Rotation>& rotations = reports[k].rotations;
        if (i >= rotations.size()) continue;
        corrected.joints[static_cast<std::size_t>(numbers[k])] = rotations[i].trace.corrected;
      }
      arm::FinishArm(arm_, corrected, fold.train, fold.held_out, &fold.loop);
      nominal.push_back(fold.loop.held_out_nominal);
      before.push_back(fold.loop.held_out_before);
      after.push_back(fold.loop.held_out_after);
      rows.push_back(static_cast<double>(fold.held_out.front().front().size()));
    }
    loop_.held_out_nominal = arm::Pooled(nominal, rows);
    loop_.held_out_before = arm::Pooled(before, rows);
    loop_.held_out_after = arm::Pooled(after, rows);
  }

 private:
  void LeaveOneOut(const actuator::RobotModel& robot, const identify::ProcessingOptions& wished) {
    for (std::size_t i = 0; i < train_.front().size(); ++i) {
      ArmFold fold;
      for (std::size_t j = 0; j < train_.size(); ++j) {
        trace::Fold of_joint = trace::LeaveOneOut(train_[j], robot.joints[j]).at(i);
        fold.train.push_back(std::move(of_joint.train));
        fold.held_out.push_back({std::move(of_joint.held_out)});
      }
      fold.loop = arm::FitArm(arm_, robot, wished, &fold.train, &fold.held_out);
      folds_.push_back(std::move(fold));
    }
  }

  arm::Arm arm_;
  const arm::ArmRuns& train_;
  const arm::ArmRuns& held_out_;
  arm::ArmLoop& loop_;
  std::vector<ArmFold> folds_;
};

}  // namespace

void TraceJoints(const Options& options, Input input, Result* out) {
  actuator::RobotModel& robot = input.model.robot;
  const std::size_t count = robot.joints.size();
  std::vector<int> numbers(options.joint ? 1 : count, options.joint.value_or(0));
  if (!options.joint) std::iota(numbers.begin(), numbers.end(), 0);
  const bool is_arm =
      std::any_of(robot.joints.begin(), robot.joints.end(),
                  [](const actuator::JointModel& joint) { return joint.Find("rigid_body") >= 0; });
  const bool alone = !is_arm && numbers.size() == 1;
  if (!alone && options.by_simulation) {
    throw UsageError("--by simulation: expected one joint (--joint) that is no part of an arm");
  }
  arm::ArmRuns train(count), held_out(count);
  for (std::size_t j = 0; j < count; ++j) {
    const auto number = static_cast<int>(j);
    if (alone && number != numbers.front()) continue;
    train[j] = ReadJoint(options.train, input.map, number);
    held_out[j] = ReadJoint(options.held_out, input.held_out_map, number);
  }
  std::vector<gate::GateReport> gates;  // of an arm's joints
  const bool rotates = options.held_out.empty();
  std::optional<FittedArm> arm;
  arm::ArmRuns all_held_out;  // of the arm's last fit
  if (is_arm) {
    gates = ExamineArm(options, robot, &train, &held_out);
    if (rotates) RequireRotation(options, train.front());
    trace::RequireHeldOut(train.front(), held_out.front());
    if (!AnyStops(gates)) {
      all_held_out = rotates ? train : held_out;
      arm.emplace(options, input, &train, &all_held_out, &robot, &out->arm.emplace());
      out->model.robot = robot;
      if (!rotates) held_out = all_held_out;
    }
  }
  std::vector<report::Page> pages;
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto j = static_cast<std::size_t>(numbers[i]);
    JointTask task = {.joint = numbers[i],
                      .train = train[j],
                      .held_out = held_out[j],
                      .searches = static_cast<int>(numbers.size())};
    task.progress = [&options, i, &numbers](double share) {
      if (!options.progress) return;
      options.progress((static_cast<double>(i) + share) / static_cast<double>(numbers.size()));
    };
    if (is_arm) task.gate = gates[j];
    if (arm) arm->Ask(j, out->model.robot, &task);
    pages.push_back(TraceJoint(options, input, std::move(task), out));
  }
  if (arm) arm->Finish(numbers, out->joints, &out->model.robot);
  if (alone) {
    out->page = std::move(pages.front());
    out->json = types::JsonText(report::ReportJson(out->joints.front()), 2) + "\n";
  } else {
    out->assessed = !AnyStops(gates);
    ReportRobot(std::move(pages), out);
  }
}

}  // namespace sinew::close_loop

// joint_command: what a controller may never send, whatever comes in.
#include <algorithm>

#include "components/topics/node/topics.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

constexpr int kSettleTicks = 5;  // until a change of state has arrived

bool Drives(const Facts& facts) { return facts.drives; }
bool IsNotFinite(const Facts& facts) { return !facts.finite; }

// Ticks like the moment, and the share of the role's outputs for which the condition holds.
double ShareWhile(RealTimeRun& run, const Moment& moment, bool (*condition)(const Facts&)) {
  (void)run.stage.Play(moment, kSettleTicks);
  const Window window = run.stage.Play(moment, kWindowTicks);
  double share = 0.0;
  for (const node::TopicInfo& topic : run.role.must_write) {
    share = std::max(share, ShareOf(window.Of(topic.name), condition));
  }
  return share;
}

}  // namespace

void CheckJointCommands(RealTimeRun& run) {
  const Window window = run.stage.Play(run.Armed(), kWindowTicks);
  std::string wrong_count;
  for (const node::TopicInfo& topic : run.role.must_write) {
    for (const Output* output : window.Of(topic.name)) {
      const auto count = output->facts->joint_count;
      if (count && *count != run.options.joints) {
        wrong_count = topic.name + ": " + std::to_string(*count);
      }
    }
  }
  run.report.Add("joint_count", wrong_count.empty(),
                 std::to_string(run.options.joints) + " joints, as joint_state has",
                 wrong_count.empty() ? std::to_string(run.options.joints) : wrong_count);
  const double not_finite = ShareWhile(run, run.Armed(), &IsNotFinite);
  run.report.Add("finite", not_finite == 0.0, "every number is finite",
                 not_finite == 0.0 ? "all" : Percent(not_finite) + " of the outputs are not");
  if (!run.role.commands_joints) {
    for (const char* check : {"no_torque_unarmed", "estop", "finite_from_broken_inputs"}) {
      run.report.Skip(check, "the role commands no joints");
    }
    return;
  }

  std::string moved;
  for (const msg::RobotState state :
       {msg::RobotState::kDisarmed, msg::RobotState::kFault, msg::RobotState::kEstopped}) {
    Moment moment = run.Armed();
    moment.robot_state = state;
    const double share = ShareWhile(run, moment, &Drives);
    if (share > 0.0) moved += std::string(" ") + NameOf(state) + ": in " + Percent(share) + ";";
  }
  run.report.Add("no_torque_unarmed", moved.empty(),
                 "COMMAND_IDLE or no torque while the robot is disarmed, in fault or estopped",
                 moved.empty() ? "none" : "torque" + moved);

  (void)run.stage.Play(run.Armed(), kSettleTicks);
  run.stage.Send(msg::OperatorAction::kEstop);
  const double after_estop = ShareWhile(run, run.Armed(), &Drives);
  run.stage.Send(msg::OperatorAction::kReset);
  (void)run.stage.Play(run.Disarmed(), kSettleTicks);
  run.report.Add("estop", after_estop == 0.0,
                 "no torque after OPERATOR_ESTOP, before the state provider reports it",
                 after_estop == 0.0 ? "none" : "torque in " + Percent(after_estop));

  double broken = 0.0;
  for (const bool of_reference : {false, true}) {
    (void)run.stage.Play(run.Armed(), kSettleTicks);
    Moment lost = run.Armed();
    (of_reference ? lost.reference_is_nan : lost.positions_are_nan) = true;
    broken = std::max(broken, ShareWhile(run, lost, &IsNotFinite));
    // A fault that this latched is for the operator to clear: disarmed, and armed again.
    (void)run.stage.Play(run.Disarmed(), kSettleTicks);
  }
  run.report.Add("finite_from_broken_inputs", broken == 0.0,
                 "every number is finite while measured positions or the reference are not",
                 broken == 0.0 ? "all" : Percent(broken) + " of the outputs are not");
}

}  // namespace sinew::conform

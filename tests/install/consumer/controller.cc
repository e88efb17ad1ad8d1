// A controller of our own for one joint: PID on the output angle. Until it is handed over to, its
// integral follows the owner's command, so that taking over makes no jump.
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>

#include <algorithm>
#include <cmath>

#include "components/topics/node/tick_loop.h"

namespace {

// At the motor shaft: the rig's 18.7 N m/rad, 5.75 N m/(rad s), 0.945 N m s/rad / (100 x 0.77).
constexpr double kProportional = 0.243, kIntegral = 0.0747, kDerivative = 0.0123, kLimit_Nm = 0.398;
// A late reference is continued for this long, as in a take-over.
constexpr double kGrace_s = 0.035;

void Run(const sinew::node::Options& options, sinew::node::StopFlag& stop) {
  using namespace sinew;
  if (!options.config_path.empty()) throw UsageError("--config: expected none, gains are built in");
  node::Node node(options);
  node::TickLoop loop(node, stop);
  auto& state = loop.AddInput(node::kJointState);
  auto& reference = loop.AddInput(node::kReference);
  auto owner = node.MakeReader(node::kJointCommand);
  auto operators = node.MakeReader(node::kOperatorCommand);
  auto output = node.MakeWriter(node::kJointCommand);
  double integral_Nm = 0.0, feedback_Nm = 0.0, target_rad = 0.0;
  std::uint64_t session = 0, last_tick = 0;
  bool estopped = false, driving = false;
  while (const auto tick = loop.Next()) {
    while (const auto word = operators.TakeNext()) {
      const bool ours = word->header.session_id == tick->session_id;
      estopped = word->action == msg::OperatorAction::kEstop ||
                 (estopped && !(ours && word->action == msg::OperatorAction::kReset));
    }
    while (const auto theirs = owner.TakeNext()) {  // of the last tick, when another one drives
      const auto writer = node.NameOf(owner.writer());
      const msg::Header& head = theirs->header;
      const double torque_Nm = theirs->motor_torque_Nm[0];
      if ((writer && writer->own) || !std::isfinite(torque_Nm)) continue;
      if (head.session_id != session || head.tick != last_tick) continue;
      integral_Nm = torque_Nm - feedback_Nm;
    }
    const msg::JointState& s = state.value();
    const double position_rad = s.position_rad[0], velocity_rad_s = s.velocity_rad_s[0];
    const bool armed =
        s.robot_state == msg::RobotState::kArmed || s.robot_state == msg::RobotState::kDamped;
    const bool known = s.valid[0] && std::isfinite(position_rad) && std::isfinite(velocity_rad_s);
    const bool drives = armed && known && !estopped;
    if (!driving || session != tick->session_id) target_rad = position_rad, integral_Nm = 0.0;
    driving = drives, session = tick->session_id, last_tick = tick->tick;

    const msg::Reference& r = reference.value();
    const double late_s = tick->period_s * static_cast<double>(tick->tick - reference.tick());
    const bool led = reference.has_value() && late_s <= kGrace_s && !r.idle && !r.stale &&
                     std::isfinite(r.position_rad[0]) && std::isfinite(r.velocity_rad_s[0]);
    if (led) target_rad = r.position_rad[0] + late_s * r.velocity_rad_s[0];
    const double rate_rad_s = led ? r.velocity_rad_s[0] : 0.0;
    msg::JointCommand command;
    command.reference_tick = reference.has_value() ? reference.tick() : 0;
    command.stale = !known || !reference.fresh() || !(led || r.idle);
    command.joint_count = s.joint_count;
    if (drives) {
      const double error_rad = target_rad - position_rad;
      feedback_Nm = kProportional * error_rad + kDerivative * (rate_rad_s - velocity_rad_s);
      integral_Nm =
          std::clamp(integral_Nm + kIntegral * error_rad * tick->period_s, -kLimit_Nm, kLimit_Nm);
      command.mode[0] = msg::CommandMode::kTorque;
      command.motor_torque_Nm[0] = std::clamp(feedback_Nm + integral_Nm, -kLimit_Nm, kLimit_Nm);
    }
    loop.Publish(output, command, *tick);
  }
}

}  // namespace

int main(int argc, char** argv) {
  return sinew::node::RunParticipant(argc, argv, "control", "PID of one joint", Run);
}

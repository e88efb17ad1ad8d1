#include "components/robot/reference/participant/translate.h"

#include "components/base/types/operator_action.h"
#include "components/base/types/robot_state.h"
#include "components/topics/node/codec.h"

namespace sinew::reference {

RobotReferenceInput ToInput(const node::Tick& tick, const msg::JointState& state) {
  RobotReferenceInput input;
  input.session_id = tick.session_id;
  input.tick = tick.tick;
  input.period_s = tick.nominal_period_s;
  input.may_move = types::MayMove(state.robot_state);
  input.joint_count = state.joint_count;
  input.position_rad = state.position_rad;
  input.valid = state.valid;
  return input;
}

OperatorStarts::OperatorStarts(node::Node& node)
    : commands_(node.MakeReader(node::kOperatorCommand)) {}

void OperatorStarts::AddTo(RobotReferenceInput* input, types::Origin origin, node::TickLoop* loop) {
  while (const auto command = commands_.TakeNext()) {
    const types::OperatorAction action = command->action;
    const bool start = action == types::OperatorAction::kStart;
    if (!start && action != types::OperatorAction::kStop) continue;
    if (!gate_.Admits(types::KindOf(action), command->header, {input->session_id, origin})) {
      continue;
    }
    loop->Used(node::EventId(*command));
    input->operator_start = start;
    input->operator_stop = !start;
  }
}

RobotReferenceOutput FromMessage(const msg::Reference& message) {
  RobotReferenceOutput output;
  output.joint_count = message.joint_count;
  output.idle = message.idle;
  output.stale = message.stale;
  for (std::size_t j = 0; j < output.joint.size(); ++j) {
    output.joint[j] = {message.position_rad[j], message.velocity_rad_s[j],
                       message.acceleration_rad_s2[j]};
  }
  return output;
}

msg::Reference ToMessage(const RobotReferenceOutput& output, const node::Tick& tick) {
  msg::Reference message;
  message.state_tick = tick.tick;
  message.stale = output.stale;
  message.idle = output.idle;
  message.joint_count = static_cast<std::uint8_t>(output.joint_count);
  for (std::size_t j = 0; j < output.joint.size(); ++j) {
    message.position_rad[j] = output.joint[j].position_rad;
    message.velocity_rad_s[j] = output.joint[j].velocity_rad_s;
    message.acceleration_rad_s2[j] = output.joint[j].acceleration_rad_s2;
  }
  return message;
}

}  // namespace sinew::reference

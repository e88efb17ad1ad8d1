#include "components/robot/provider/participant/command_readers.h"

#include <spdlog/spdlog.h>

#include "components/robot/provider/participant/simulation_messages.h"

namespace sinew::provider {

namespace {

JointSetpoints FromMessage(const msg::JointCommand& message) {
  JointSetpoints command;
  command.header = message.header;
  command.joint_count = message.joint_count;
  command.mode = message.mode;
  command.motor_torque_Nm = message.motor_torque_Nm;
  command.position_rad = message.position_rad;
  command.velocity_rad_s = message.velocity_rad_s;
  return command;
}

ValveCommand FromMessage(const msg::ValveCommand& message) {
  return {.header = message.header,
          .joint_count = message.joint_count,
          .valve_open = message.valve_open,
          .compressor_on = message.compressor_on,
          .vent_open = message.vent_open};
}

PressureMessage FromMessage(const msg::SimPressure& message) {
  return {.header = message.header,
          .joint_count = message.joint_count,
          .pressure = {.imposed = message.imposed,
                       .chamber_pressure_bar = message.chamber_pressure_bar}};
}

// Empty: not refused.
const char* Refusal(OperatorResult result) {
  switch (result) {
    case OperatorResult::kRefusedOtherSession:
      return "refused: meant for another session";
    case OperatorResult::kRefusedOrigin:
      return "refused: it comes from a recording or a simulation";
    case OperatorResult::kRefusedByPlant:
      return "refused by the plant";
    case OperatorResult::kRefusedByFallGuard:
      return "refused by the fall detector";
    case OperatorResult::kRefusedByCommand:
      return "refused: the controller is of another robot";
    case OperatorResult::kRefusedByEstop:
      return "refused: an estop is not watched, or held";
    case OperatorResult::kRefusedUnanswered:
      return "refused: no controller answers";
    case OperatorResult::kRefusedResetFirst:
      return "refused: reset first";
    case OperatorResult::kRefusedDisarmFirst:
      return "refused: disarm first";
    case OperatorResult::kDone:
    case OperatorResult::kClearFaults:
    case OperatorResult::kUnlatchFirst:
    case OperatorResult::kNotForProvider:
      break;
  }
  return "";
}

}  // namespace

CommandSource::CommandSource(node::Node& node)
    : node_(node), writer_(node.MakeWriter(node::kCommandSource)) {}

node::Node::WriterName CommandSource::NameOf(const std::optional<node::WriterId>& writer) const {
  if (!writer) return {};
  node::Node::WriterName name = node_.NameOf(*writer).value_or(node::Node::WriterName{});
  // GUIDs are random, and runs in lockstep repeat to the byte.
  if (node_.options().mode == node::TimeMode::kLockstep) name.guid.clear();
  return name;
}

void CommandSource::Publish(const types::MessageHeader& header) {
  if (!changed_) return;
  changed_ = false;
  const node::Node::WriterName joint = NameOf(joint_command_), valve = NameOf(valve_command_);
  spdlog::info("tick {}: joint_command of '{}', valve_command of '{}'", header.tick,
               joint.participant, valve.participant);
  msg::CommandSource message;
  message.header = header;
  message.joint_command_participant = joint.participant.substr(0, 64);
  message.joint_command_guid = joint.guid.substr(0, 64);
  message.valve_command_participant = valve.participant.substr(0, 64);
  message.valve_command_guid = valve.guid.substr(0, 64);
  if (writer_.Write(message) != node::WriteStatus::kOk) {
    changed_ = true;  // tried again in the next cycle
  }
}

CommandReaders::CommandReaders(node::Node& node, ProviderCycle& cycle, Plant& plant,
                               OnOperator on_operator)
    : node_(node),
      cycle_(cycle),
      plant_(plant),
      on_operator_(std::move(on_operator)),
      simulated_(dynamic_cast<SimulatedPlant*>(&plant)),
      joint_command_(node.MakeReader(node::kJointCommand)),
      valve_command_(node.MakeReader(node::kValveCommand)),
      operator_command_(node.MakeReader(node::kOperatorCommand)),
      source_(node),
      pressure_source_(cycle.session_id(), cycle.period(), cycle.fault_after()) {
  if (simulated_ == nullptr) return;
  disturbance_.emplace(node.MakeReader(node::kSimDisturbance));
  pressure_.emplace(node.MakeReader(node::kSimPressure));
  if (simulated_->body_truth() == nullptr) return;
  body_disturbance_.emplace(node.MakeReader(node::kSimBodyDisturbance));
}

void CommandReaders::TakeOperatorCommands(std::uint64_t tick) {
  while (const auto command = operator_command_.TakeNext()) {
    const types::MessageHeader& header = command->header;
    const OperatorResult result = cycle_.Take(
        {.session_id = header.session_id, .origin = header.origin, .action = command->action},
        tick);
    if (result == OperatorResult::kClearFaults) plant_.ClearFault();
    std::string refusal = on_operator_(result, command->action, command->reason);
    if (refusal.empty()) refusal = Refusal(result);
    LogOperator(*command, refusal);
  }
  if (simulated_ != nullptr) TakeDisturbances();
}

// A flood of commands must not fill the log, nor the cycle with its lines.
void CommandReaders::LogOperator(const msg::OperatorCommand& command, const std::string& refusal) {
  constexpr int kLinesEachSecond = 10;  // as often as `sinew arm` repeats itself
  const auto now = std::chrono::steady_clock::now();
  if (now >= operator_second_ + std::chrono::seconds(1)) {
    operator_second_ = now;
    operator_lines_ = 0;
  }
  if (++operator_lines_ > kLinesEachSecond) {
    ++operator_unlogged_;
    return;
  }
  spdlog::log(refusal.empty() ? spdlog::level::info : spdlog::level::warn,
              "operator: action {}, reason '{}'{}{}{}", static_cast<int>(command.action),
              command.reason, refusal.empty() ? "" : ": ", refusal,
              operator_unlogged_ == 0
                  ? ""
                  : " (" + std::to_string(operator_unlogged_) + " before it not logged)");
  operator_unlogged_ = 0;
}

void CommandReaders::TakeDisturbances() {
  while (const auto disturbance = disturbance_->TakeNext()) {
    if (!disturbance_gate_.Admits(types::CommandKind::kRequest, disturbance->header,
                                  cycle_.running())) {
      continue;
    }
    simulated_->Disturb(
        {.hand_force_N = disturbance->load_force_N, .extra_payload_kg = disturbance->payload_kg});
  }
  while (body_disturbance_) {
    const auto message = body_disturbance_->TakeNext();
    if (!message) break;
    const types::MessageHeader& header = message->header;
    if (header.session_id == cycle_.session_id()) body_answers_ = header.tick + 1;
    if (!body_gate_.Admits(types::CommandKind::kRequest, header, cycle_.running())) continue;
    const BodyDisturbance disturbance = FromMessage(*message);
    if (!IsPossible(disturbance)) {
      body_gate_.Refuse("a value that is not finite, a mass below 0, or a share outside 0 to 1");
    } else if (!disturbance.lost_drive.empty() && !simulated_->HasDrive(disturbance.lost_drive)) {
      body_gate_.Refuse("lost_drive is no joint of this robot: " + disturbance.lost_drive);
    } else {
      simulated_->DisturbBody(disturbance);
    }
  }
}

std::optional<int> CommandReaders::OtherJoint() {
  const std::uint64_t changes = node_.EndpointChanges();
  const bool is_known = compared_ == joint_command_.writer();
  if (is_known && compared_at_ == changes) return other_joint_;
  const bool was_logged = is_known && other_joint_;
  compared_ = joint_command_.writer();
  compared_at_ = changes;
  other_joint_.reset();
  const std::vector<std::string> names = node_.JointNamesOf(compared_);
  for (int j = 0; j < plant_.joint_count() && j < static_cast<int>(names.size()); ++j) {
    const std::string& commanded = names[static_cast<std::size_t>(j)];
    const std::string own = plant_.joint_name(j);
    if (own.empty() || commanded.empty() || own == commanded) continue;
    other_joint_ = j;
    if (!was_logged) {
      spdlog::error("joint {} is '{}', and '{}' in the configuration of its controller", j, own,
                    commanded);
    }
    break;
  }
  return other_joint_;
}

void CommandReaders::TakeAll(std::uint64_t tick) {
  TakeOperatorCommands(tick);
  while (const auto command = joint_command_.TakeNext()) {
    JointSetpoints setpoints = FromMessage(*command);
    setpoints.other_joint = OtherJoint();
    if (cycle_.Take(setpoints, tick)) {
      source_.SetJointCommandWriter(joint_command_.writer());
    }
  }
  while (const auto command = valve_command_.TakeNext()) {
    if (cycle_.Take(FromMessage(*command), tick)) {
      source_.SetValveCommandWriter(valve_command_.writer());
    }
  }
  if (simulated_ == nullptr) return;
  while (const auto pressure = pressure_->TakeNext()) {
    pressure_source_.Take(FromMessage(*pressure), tick);
  }
  const bool stopped =
      cycle_.state() == types::RobotState::kFault || cycle_.state() == types::RobotState::kEstopped;
  simulated_->ImposePressure(pressure_source_.Current(tick, stopped));
}

}  // namespace sinew::provider

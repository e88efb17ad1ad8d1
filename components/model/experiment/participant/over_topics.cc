#include "components/model/experiment/participant/over_topics.h"

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/simulation.h>

#include <chrono>
#include <stdexcept>

#include "components/base/types/robot_state.h"
#include "components/base/types/seconds.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::experiment {
namespace {

constexpr std::uint64_t kRepeatArm = 24;    // ticks
constexpr std::uint64_t kReportEvery = 24;  // ticks
constexpr int kFarewellTicks = 3;           // of idle commands at the end
constexpr Command kAtRest{.valve_open = false};

Reading ToReading(const msg::JointState& state, const msg::ActuatorState& actuator,
                  std::size_t joint) {
  Reading reading;
  reading.output_angle_rad = state.position_rad[joint];
  reading.output_velocity_rad_s = state.velocity_rad_s[joint];
  reading.motor_angle_rad = actuator.motor_position_rad[joint];
  reading.motor_velocity_rad_s = actuator.motor_velocity_rad_s[joint];
  reading.motor_current_A = actuator.motor_current_A[joint];
  reading.chamber_pressure_bar = actuator.chamber_pressure_bar[joint];
  reading.reservoir_pressure_bar = actuator.reservoir_pressure_bar[joint];
  reading.load_force_N = actuator.load_force_N[joint];
  reading.valve_open = actuator.valve_open[joint];
  return reading;
}

// A protocol needs the robot for itself; in lockstep a second writer would answer in its place, in
// real time it would stand by for ever.
void RequireNoOtherWriter(const node::Node& node, std::string_view topic) {
  for (const node::Endpoint& endpoint : node.Endpoints()) {
    if (endpoint.is_writer && endpoint.topic == topic) {
      throw std::runtime_error("'" + endpoint.participant + "' writes " + std::string(topic) +
                               " in domain " + std::to_string(node.options().domain_id) +
                               "; stop it: an experiment commands the robot by itself");
    }
  }
}

// presence: only to see whether there is a provider; nothing is read from it, so it ends with the
// wait.
void AwaitRobot(node::Node& node, node::StopFlag& stop, double wait_s,
                node::Reader<msg::JointState> presence) {
  const auto give_up = std::chrono::steady_clock::now() + types::ToNanoseconds(wait_s);
  while (presence.matched_writers() == 0 && !stop.requested()) {
    if (std::chrono::steady_clock::now() > give_up) {
      throw std::runtime_error("no state provider in domain " +
                               std::to_string(node.options().domain_id) + " within " +
                               std::to_string(static_cast<int>(wait_s)) + " s");
    }
    node.WaitForData(std::chrono::milliseconds(50));
  }
  RequireNoOtherWriter(node, node::kJointCommand.name);
  RequireNoOtherWriter(node, node::kValveCommand.name);
}

msg::OperatorCommand OperatorCommand(msg::OperatorAction action, const msg::JointState& state) {
  msg::OperatorCommand command;
  command.header = state.header;
  command.action = action;
  command.reason = "experiment";
  return command;
}

// The outgoing side: three topics a tick.
class Output {
 public:
  explicit Output(node::Node& node)
      : joint_(node.MakeWriter(node::kJointCommand)),
        valve_(node.MakeWriter(node::kValveCommand)),
        hand_(node.MakeWriter(node::kSimDisturbance)) {}

  void Send(node::TickLoop& loop, const node::Tick& tick, std::size_t joint, int joint_count,
            const Command& command) {
    const auto count = static_cast<std::uint8_t>(joint_count);
    // The hand first: the provider takes it with the commands that follow.
    msg::SimDisturbance hand;
    hand.joint_count = count;
    hand.load_force_N[joint] = command.hand_force_N;
    loop.Publish(hand_, hand, tick);
    msg::ValveCommand valve;
    valve.joint_count = count;
    valve.valve_open[joint] = command.valve_open;
    valve.compressor_on[joint] = command.compressor_on;
    valve.vent_open[joint] = command.vent_open;
    loop.Publish(valve_, valve, tick);
    msg::JointCommand drive;
    drive.joint_count = count;
    drive.mode[joint] = command.drive;
    drive.motor_torque_Nm[joint] = command.motor_torque_Nm;
    drive.position_rad[joint] = command.position_rad;
    loop.Publish(joint_, drive, tick);
  }

 private:
  node::Writer<msg::JointCommand> joint_;
  node::Writer<msg::ValveCommand> valve_;
  node::Writer<msg::SimDisturbance> hand_;
};

}  // namespace

TopicRun RunOverTopics(node::Node& node, node::StopFlag& stop, Prepared& protocol,
                       const TopicOptions& options,
                       const std::function<void(const TopicProgress&)>& progress) {
  node::TickLoop loop(node, stop);
  auto& state_input = loop.AddInput(node::kJointState);
  auto& actuator_input = loop.AddInput(node::kActuatorState);
  node::Reader<msg::JointState> presence = node.MakeReader(node::kJointState);
  Output output(node);
  auto operator_writer = node.MakeWriter(node::kOperatorCommand);
  const auto joint = static_cast<std::size_t>(options.joint);

  AwaitRobot(node, stop, options.wait_s, std::move(presence));

  TopicRun run;
  std::optional<std::int64_t> first_stamp_ns;
  bool armed_once = false;
  int farewell = 0;
  std::uint64_t ticks = 0;
  run.end = "the session ended";
  const auto send = [&](msg::OperatorAction action) {
    (void)operator_writer.Write(OperatorCommand(action, state_input.value()));
  };
  while (const auto tick = loop.Next()) {
    const msg::JointState& state = state_input.value();
    run.simulated = tick->origin != msg::Origin::kLive;
    const types::RobotState robot_state = state.robot_state;
    const bool armed = types::MayMove(robot_state);
    const bool stopped =
        robot_state == types::RobotState::kFault || robot_state == types::RobotState::kEstopped;
    if (options.joint >= state.joint_count) {
      run.end = "the robot has " + std::to_string(state.joint_count) + " joints";
      break;
    }
    Command command = kAtRest;
    if (farewell > 0) {
      output.Send(loop, *tick, joint, state.joint_count, command);
      if (++farewell > kFarewellTicks) break;
      continue;
    }
    if (stopped || (armed_once && !armed)) {
      run.end = stopped ? "the robot is in fault or stopped" : "the robot was disarmed";
      break;
    }
    if (!armed && options.arm && ticks % kRepeatArm == 0) send(msg::OperatorAction::kArm);
    if (armed && actuator_input.has_value()) {
      armed_once = true;
      if (!first_stamp_ns) first_stamp_ns = tick->stamp_ns;
      Reading reading = ToReading(state, actuator_input.value(), joint);
      reading.time_s = 1e-9 * static_cast<double>(tick->stamp_ns - *first_stamp_ns);
      command = protocol.Step(reading);
      if (protocol.ready()) {
        if (run.rows.empty()) {
          run.started_s = 1e-9 * static_cast<double>(*first_stamp_ns) + protocol.started_s();
        }
        Row row = reading;
        row.time_s -= protocol.started_s();
        if (actuator_input.fresh() && state.valid[joint]) run.rows.push_back(row);
      }
      if (protocol.done()) {
        run.done = true;
        run.end = "done";
        farewell = 1;
        command = kAtRest;
      }
    }
    output.Send(loop, *tick, joint, state.joint_count, command);
    if (progress && ticks % kReportEvery == 0) {
      progress({first_stamp_ns ? 1e-9 * static_cast<double>(tick->stamp_ns - *first_stamp_ns) : 0.0,
                armed ? protocol.instruction()
                      : std::string("arm the robot: sinew arm --domain ") +
                            std::to_string(node.options().domain_id),
                armed, protocol.ready()});
    }
    ++ticks;
  }
  if (options.arm && armed_once && state_input.has_value()) send(msg::OperatorAction::kDisarm);
  if (stop.requested() && !run.done) run.end = "stopped";
  return run;
}

}  // namespace sinew::experiment

// The messages that a state provider reads, handed to the cycle's decisions: operator_command,
// joint_command, valve_command; sim_disturbance and sim_pressure go to the plant, for simulated
// plants only, and sim_body_disturbance for those on a floating base.
// Thread: the provider's loop.
#pragma once

#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/pneumatics.h>
#include <sinew_idl/simulation.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "components/base/types/message_header.h"
#include "components/robot/provider/pressure_source.h"
#include "components/robot/provider/provider_cycle.h"
#include "components/robot/provider/simulated_plant.h"
#include "components/topics/node/command_gate.h"
#include "components/topics/node/node.h"

namespace sinew::provider {

// Publishes whose commands the state provider obeys: command_source, when that changes. Ownership
// of a topic is decided by each reader for itself; this is the provider's.
class CommandSource {
 public:
  // Throws DdsError.
  explicit CommandSource(node::Node& node);

  // Writers of the newest commands that count.
  void SetJointCommandWriter(const node::WriterId& writer) { Set(&joint_command_, writer); }
  void SetValveCommandWriter(const node::WriterId& writer) { Set(&valve_command_, writer); }
  // With the header of the running cycle. Writes and logs only when there is something new.
  void Publish(const types::MessageHeader& header);

 private:
  void Set(std::optional<node::WriterId>* writer, const node::WriterId& newest) {
    changed_ = changed_ || *writer != newest;
    *writer = newest;
  }
  node::Node::WriterName NameOf(const std::optional<node::WriterId>& writer) const;

  node::Node& node_;
  node::Writer<msg::CommandSource> writer_;
  std::optional<node::WriterId> joint_command_, valve_command_;
  bool changed_ = false;
};

class CommandReaders {
 public:
  // Called with every command, with the operator's reason. Returns why it was refused, for the log;
  // empty: as `result` says.
  using OnOperator = std::function<std::string(OperatorResult result, types::OperatorAction action,
                                               std::string_view reason)>;
  // Cycle and plant must outlive it. Throws DdsError.
  CommandReaders(node::Node& node, ProviderCycle& cycle, Plant& plant, OnOperator on_operator);

  // Takes what has arrived since the last call. Operator commands are logged, ten a second at most;
  // a reset clears the plant's faults.
  void TakeOperatorCommands(std::uint64_t tick);
  // The same, and then joint and valve commands and imposed pressures.
  void TakeAll(std::uint64_t tick);

  // Publishes the writers of those commands, when they have changed.
  void PublishSource(const types::MessageHeader& header) { source_.Publish(header); }

  // Block until a sample arrives or the timeout is over.
  void WaitForJointCommand(std::chrono::microseconds timeout) {
    joint_command_.WaitForSample(timeout);
  }
  void WaitForValveCommand(std::chrono::microseconds timeout) {
    valve_command_.WaitForSample(timeout);
  }
  // Hardware answers nothing: waiting ends with its timeout.
  void WaitForPressure(std::chrono::microseconds timeout) {
    if (pressure_) pressure_->WaitForSample(timeout);
  }
  // Only where has_body(): a fixed base reads none.
  void WaitForBodyDisturbance(std::chrono::microseconds timeout) {
    if (body_disturbance_) body_disturbance_->WaitForSample(timeout);
  }
  // As ProviderCycle::joint_answers, for sim_pressure and sim_body_disturbance.
  std::uint64_t pressure_answers() const { return pressure_source_.answers(); }
  std::uint64_t body_disturbance_answers() const { return body_answers_; }
  bool simulated() const { return simulated_ != nullptr; }
  bool has_body() const { return body_disturbance_.has_value(); }

 private:
  void TakeDisturbances();
  // The joint that the node of joint_command's newest writer names otherwise than the plant, first
  // of all; a joint without a name there or here is not compared.
  std::optional<int> OtherJoint();
  void LogOperator(const msg::OperatorCommand& command, const std::string& refusal);

  node::Node& node_;
  ProviderCycle& cycle_;
  Plant& plant_;
  OnOperator on_operator_;
  int operator_lines_ = 0;  // in this second
  std::uint64_t operator_unlogged_ = 0;
  std::chrono::steady_clock::time_point operator_second_{};
  SimulatedPlant* simulated_;  // the plant, where it is a simulation
  node::Reader<msg::JointCommand> joint_command_;
  // As OtherJoint found it of this writer, after so many changes of discovery.
  node::WriterId compared_{};
  std::uint64_t compared_at_ = 0;
  std::optional<int> other_joint_;
  node::Reader<msg::ValveCommand> valve_command_;
  node::Reader<msg::OperatorCommand> operator_command_;
  std::optional<node::Reader<msg::SimDisturbance>> disturbance_;
  node::CommandGate disturbance_gate_{"sim_disturbance"};
  std::optional<node::Reader<msg::SimBodyDisturbance>> body_disturbance_;
  node::CommandGate body_gate_{"sim_body_disturbance"};
  std::uint64_t body_answers_ = 0;
  CommandSource source_;
  std::optional<node::Reader<msg::SimPressure>> pressure_;
  PressureSource pressure_source_;
};

}  // namespace sinew::provider

// A small controller with the role control that breaks one rule of the contract, named by
// --violate; without it, it keeps them all. `sinew conform` has to find each.
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/status.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include "components/base/config/config.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/tick_loop.h"

namespace {

using namespace sinew;

constexpr double kTorque_Nm = 0.01;

std::string violation;  // of the process; set before anything else runs

bool Violates(const std::string& name) { return violation == name; }

void LoadViolatorConfig(const std::filesystem::path& path) {
  if (path.empty() && Violates("mute_without_config")) std::exit(3);
  if (path.empty() || Violates("ignores_config")) return;
  const auto root = config::Section::Load(path, "sinew-violator/1");
  if (!Violates("ignores_unknown_key")) root.RejectUnknownKeys();
}

node::TopicInfo CommandTopic() {
  node::TopicInfo topic = *node::FindTopic(node::kJointCommand.name);
  if (Violates("other_type")) topic.dds_type_name += "0";
  if (Violates("shared_ownership")) topic.profile = node::Profile::kState;
  return topic;
}

// Another participant that publishes a status under the same name.
class FalseStatus {
 public:
  explicit FalseStatus(node::Options options) : name_(options.name) {
    options.name = "impostor";
    node_ = std::make_unique<node::Node>(options);
    writer_.emplace(node_->MakeWriter(node::kComponentStatus));
    while (writer_->matched_readers() == 0) node_->WaitForData(std::chrono::milliseconds(5));
    thread_ = std::thread([this] {
      for (; !ended_; std::this_thread::sleep_for(std::chrono::milliseconds(1))) Publish();
    });
  }
  ~FalseStatus() {
    ended_ = true;
    thread_.join();
  }

 private:
  void Publish() {
    msg::ComponentStatus status;
    status.name = name_;
    status.component_kind = "control";
    status.state = msg::ComponentState::kActive;
    status.idl_hash = "00000000";
    (void)writer_->Write(status);
  }

  std::string name_;
  std::unique_ptr<node::Node> node_;
  std::optional<node::Writer<msg::ComponentStatus>> writer_;
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

// A controller on readers of its own: it neither looks at sessions nor counts what is malformed,
// and answers only when a reference has come.
void RunOnReaders(node::Node& node, node::StopFlag& stop) {
  auto states = node.MakeReader(node::kJointState);
  std::atomic<int> references{0};
  node.ReadRaw(*node::FindTopic(node::kReference.name), [&references](node::RawSample&& sample) {
    msg::Reference reference;
    if (node::Decode(sample.payload, &reference)) {
      references = 2;  // for this tick and the one that may be under way
    } else if (Violates("crashes_on_malformed")) {
      std::abort();
    }
  });
  auto output = node.MakeWriter(node::kJointCommand);
  node.SetState(node::Node::State::kConfigured);
  while (!stop.requested()) {
    const auto state = states.WaitNext(std::chrono::milliseconds(50));
    if (!state) continue;
    node.SetState(node::Node::State::kActive);
    const bool fresh = references > 0;
    references = std::max(0, references - 1);
    if (!fresh && Violates("waits_for_inputs")) continue;
    msg::JointCommand command;
    command.header = state->header;
    command.joint_count = state->joint_count;
    command.stale = !fresh;
    (void)output.Write(command);
    if (state->last_tick) return;
  }
}

class Violator {
 public:
  Violator(const node::Options& options, node::StopFlag& stop)
      : stop_(stop),
        node_(options),
        loop_(node_, stop),
        state_(loop_.AddInput(node::kJointState)),
        reference_(loop_.AddInput(node::kReference)),
        operator_(node_.MakeReader(node::kOperatorCommand)) {
    if (!Violates("no_writer")) output_.emplace(node_.MakeRawWriter(CommandTopic()));
    if (Violates("false_status")) status_.emplace(options);
    if (Violates("second_topic")) second_.emplace(node_.MakeWriter(node::kReference));
    if (Violates("takes_over_at_start"))
      handover_.emplace(node_.MakeWriter(node::kOperatorCommand));
  }

  void Run() {
    while (const auto tick = loop_.Next()) {
      if (Violates("mute")) continue;
      if (Violates("late")) std::this_thread::sleep_for(std::chrono::milliseconds(12));
      Step(*tick);
    }
    while (Violates("ignores_last_tick") && !stop_.requested()) {
      node_.WaitForData(std::chrono::milliseconds(50));
    }
  }

 private:
  void Step(const node::Tick& tick) {
    TakeOperatorCommands(tick);
    msg::JointCommand command = MakeCommand();
    auto& header = command.header;
    header.session_id = tick.session_id;
    if (Violates("keeps_session")) {
      if (first_session_ == 0) first_session_ = tick.session_id;
      header.session_id = first_session_;
    }
    header.tick = tick.tick + (Violates("wrong_tick") ? 1 : 0);
    header.stamp_ns = tick.stamp_ns;
    header.origin = Violates("launders_origin") ? msg::Origin::kSim : tick.origin;
    node::Bytes bytes;
    if (!node::Encode(command, &bytes)) return;
    if (output_) (void)(*output_)(bytes.data(), bytes.size());
    if (handover_) HandOverToItself(tick);
  }

  msg::JointCommand MakeCommand() {
    const msg::JointState& state = state_.value();
    const bool armed = state.robot_state == msg::RobotState::kArmed && !estopped_;
    const bool drives = (armed && reference_.fresh()) || Violates("torque_when_disarmed");
    was_stale_ = was_stale_ || !reference_.fresh();
    msg::JointCommand command;
    command.stale = !reference_.fresh();
    if (Violates("never_stale")) command.stale = false;
    if (Violates("stays_stale")) command.stale = was_stale_;
    command.joint_count =
        static_cast<std::uint8_t>(state.joint_count + (Violates("wrong_joint_count") ? 1 : 0));
    for (std::size_t j = 0; j < state.joint_count; ++j) {
      command.mode[j] = drives ? msg::CommandMode::kTorque : msg::CommandMode::kIdle;
      if (!drives) continue;
      command.motor_torque_Nm[j] = kTorque_Nm;
      if (Violates("not_finite")) command.motor_torque_Nm[j] = std::nan("");
      if (Violates("random")) command.motor_torque_Nm[j] = 1e-9 * std::random_device()();
      if (Violates("passes_nan_on")) command.position_rad[j] = state.position_rad[j];
    }
    return command;
  }

  void TakeOperatorCommands(const node::Tick& tick) {
    while (const auto command = operator_.TakeNext()) {
      if (Violates("ignores_estop")) continue;
      if (command->action == msg::OperatorAction::kEstop) estopped_ = true;
      const bool ours = command->header.session_id == tick.session_id;
      if (command->action == msg::OperatorAction::kReset && ours) estopped_ = false;
    }
  }

  void HandOverToItself(const node::Tick& tick) {
    msg::OperatorCommand command;
    command.header.session_id = tick.session_id;
    command.header.origin = msg::Origin::kSim;
    command.action = msg::OperatorAction::kHandover;
    command.role = "control";
    command.target = node_.options().name;
    (void)handover_->Write(command);
  }

  node::StopFlag& stop_;
  node::Node node_;
  node::TickLoop loop_;
  node::TickInput<msg::JointState>& state_;
  node::TickInput<msg::Reference>& reference_;
  node::Reader<msg::OperatorCommand> operator_;
  std::optional<node::RawWriter> output_;
  std::optional<FalseStatus> status_;
  std::optional<node::Writer<msg::Reference>> second_;
  std::optional<node::Writer<msg::OperatorCommand>> handover_;
  std::uint64_t first_session_ = 0;
  bool estopped_ = false, was_stale_ = false;
};

void RunViolator(node::Options options, node::StopFlag& stop) {
  LoadViolatorConfig(options.config_path);
  if (Violates("never_stops")) {
    std::signal(SIGTERM, SIG_IGN);
    std::signal(SIGINT, SIG_IGN);
  }
  if (Violates("other_kind")) options.component = "regime";
  if (Violates("refuses_handover")) options.role = "regime";
  if (Violates("reads_alone") || Violates("crashes_on_malformed") || Violates("waits_for_inputs")) {
    node::Node node(options);
    RunOnReaders(node, stop);
    return;
  }
  if (Violates("never_starts")) {
    while (!stop.requested()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return;
  }
  Violator(options, stop).Run();
}

}  // namespace

int main(int argc, char** argv) {
  return node::RunParticipant(
      argc, argv, "control", "Breaks one rule of the contract", &RunViolator,
      [](CLI::App& app) { node::AddOption(app, "--violate", &violation, "Name of the rule"); });
}

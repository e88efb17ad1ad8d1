#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <exception>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "components/base/types/fault.h"
#include "components/base/types/json_text.h"
#include "components/base/types/operator_action.h"
#include "components/robot/estop/press.h"
#include "components/robot/estop/socket_folder.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"

namespace sinew::tools {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRepeat(100);  // arm is volatile and estop must get through: say it again

struct OperatorOptions {
  node::Options node;
  double timeout_s = 5.0;
  std::string reason;
  bool json = false;
  std::vector<std::string> sockets;  // estop
};

// The provider's refusal, in its status, of an arm that was sent at this time of its session;
// empty: none. Its status is latched, and may still be of an earlier one.
std::string RefusalIn(node::Reader<msg::ComponentStatus>& statuses, const msg::Header& sent) {
  std::string refusal;
  while (const auto status = statuses.TakeNext()) {
    const std::string message = status->message;
    const bool is_of_this =
        status->header.session_id == sent.session_id && status->header.tick >= sent.tick;
    if (is_of_this && message.starts_with("arm refused")) {
      refusal = status->name + ": " + message;
    }
  }
  return refusal;
}

// Why the requested state was not reached, for the operator.
std::string Why(types::OperatorAction action, const std::optional<msg::JointState>& state,
                bool heard, int domain_id) {
  if (!state) {
    return std::string("no state provider heard in domain ") + std::to_string(domain_id) +
           (heard ? "; the command was delivered to others" : "") + isolation::OthersIn(domain_id);
  }
  if (!heard) {
    return "the robot is heard, but nobody takes commands of this process: its key, or the role of "
           "its certificate (--key, --qos)";
  }
  const std::string now = NameOf(state->robot_state);
  if (action == msg::OperatorAction::kArm && (state->robot_state == msg::RobotState::kFault ||
                                              state->robot_state == msg::RobotState::kEstopped)) {
    const std::string fault = types::FaultText(types::FromMessage(state->fault));
    return "the robot is in '" + now + "'" + (fault.empty() ? "" : ": " + fault) +
           "; then 'sinew reset'";
  }
  return "the robot stays in '" + now + "'";
}

// Answers of the sockets of state providers on this host, which need no DDS: pressed before DDS is
// started.
struct LocalEstop {
  std::filesystem::path socket;        // the last one; empty: there is none
  bool idle = false, latched = false;  // all of them
};

struct Pressed {
  std::filesystem::path path;
  estop::Press press;
};

std::vector<Pressed> PressLocally(const OperatorOptions& options) {
  std::vector<Pressed> pressed;
  for (const auto& path : estop::SocketsToPress({options.sockets.begin(), options.sockets.end()},
                                                options.node.chosen_domain)) {
    pressed.push_back({path, {path, options.reason}});
  }
  return pressed;
}

// Their answers; named: the operator asked for these sockets.
LocalEstop AnswerOf(std::vector<Pressed> pressed, bool named) {
  LocalEstop local;
  for (Pressed& one : pressed) {
    if (!one.press.sent()) {
      if (named) std::cerr << "sinew estop: " << one.press.error() << '\n';
      continue;
    }
    const estop::Press::Answer answer = one.press.Await(estop::kAnswerLimit);
    const bool first = local.socket.empty();
    local = {one.path, answer.idle && (first || local.idle),
             answer.latched && (first || local.latched)};
    if (!answer.latched || !answer.idle) {
      std::cerr << "sinew estop: " << one.path.string() << ": "
                << (answer.text.empty() ? "no answer\n" : answer.text);
    }
  }
  return local;
}

void RunOperator(types::OperatorAction action, OperatorOptions options) {
  std::vector<Pressed> pressed;  // their answers wait until DDS has the estop as well
  if (action == msg::OperatorAction::kEstop) {
    pressed = PressLocally(options);
  }
  options.node.component = "operator";
  options.node.name = "operator";
  std::optional<node::Node> made;
  try {
    made.emplace(options.node);
  } catch (const std::exception&) {  // without DDS: what the sockets say counts all the more
    (void)AnswerOf(std::move(pressed), !options.sockets.empty());
    throw;
  }
  node::Node& node = *made;
  auto states = node.MakeReader(node::kJointState);
  auto commands = node.MakeWriter(node::kOperatorCommand);
  std::optional<node::Reader<msg::ComponentStatus>> statuses;
  if (action == msg::OperatorAction::kArm)
    statuses.emplace(node.MakeReader(node::kComponentStatus));
  std::string refusal;
  msg::Header first_sent;  // what an arm is sent with

  const auto end = Clock::now() + std::chrono::duration<double>(options.timeout_s);
  auto next_send = Clock::now();
  std::optional<msg::JointState> state;
  bool sent = false, done = false;
  while (!done && refusal.empty() && Clock::now() < end) {
    if (sent && statuses) refusal = RefusalIn(*statuses, first_sent);
    if (auto newest = states.WaitNext(milliseconds(20))) state = newest;
    if (state && sent) done = types::HasReached(state->robot_state, action);
    const bool may_send =
        commands.matched_readers() > 0 && (state || !types::IsBoundToSession(action));
    if (done || !may_send || Clock::now() < next_send) continue;
    msg::OperatorCommand command;
    if (state) command.header = state->header;
    if (!sent) first_sent = command.header;
    command.action = action;
    command.reason = options.reason.substr(0, 63);
    sent = commands.Write(command) == node::WriteStatus::kOk || sent;
    next_send = Clock::now() + kRepeat;
  }

  const LocalEstop local = AnswerOf(std::move(pressed), !options.sockets.empty());
  const std::string why = done               ? ""
                          : !refusal.empty() ? refusal
                                             : Why(action, state, sent, options.node.domain_id);
  if (options.json) {
    nlohmann::ordered_json report = {{"action", NameOf(action)}, {"done", done}};
    if (state) report["robot_state"] = NameOf(state->robot_state);
    if (!local.socket.empty()) {
      report["socket"] = {
          {"path", local.socket.string()}, {"idle", local.idle}, {"latched", local.latched}};
    }
    if (!done) report["why"] = why;
    std::cout << types::JsonText(report) << '\n';
  } else if (done) {
    std::cout << "robot is " << NameOf(state->robot_state) << '\n';
  }
  if (done) return;
  std::cerr << "sinew " << NameOf(action) << ": " << why << '\n';
  if (local.idle) {
    std::cerr << "sinew estop: motors are off, by " << local.socket.string()
              << "; DDS did not confirm it\n";
    return;
  }
  throw CLI::RuntimeError(1);
}

void AddOne(CLI::App& app, types::OperatorAction action, const std::string& description,
            const std::string& note) {
  auto options = std::make_shared<OperatorOptions>();
  CLI::App* command = app.add_subcommand(NameOf(action), description);
  AddNodeOptions(*command, &options->node);
  command->add_option("--reason", options->reason, "For the log of the provider, 63 characters");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait for the robot's answer")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  if (action == msg::OperatorAction::kEstop) {
    command->add_option(
        "--socket", options->sockets,
        "Socket of a state provider on this host; by default all of them, or those of "
        "--domain");
  }
  command->add_flag("--json", options->json, "As JSON");
  command->footer(note +
                  "\nExit code 1 when the robot did not get there in time.\n\nExample:\n  sinew " +
                  NameOf(action) + " --domain 0");
  command->callback([action, options] { RunOperator(action, *options); });
}

}  // namespace

void AddOperatorCommands(CLI::App& app) {
  using types::OperatorAction;
  AddOne(app, OperatorAction::kArm, "Let the motors move",
         "Bound to the session that runs now: a restarted robot is disarmed.");
  AddOne(app, OperatorAction::kDisarm, "Motors off",
         "A robot in fault or estopped has its motors off already.");
  AddOne(app, OperatorAction::kEstop, "Motors off and latched until reset",
         "By the socket of a state provider on this host, where there is one, and by DDS: repeated "
         "until the robot reports that it has stopped.");
  AddOne(app, OperatorAction::kReset, "From fault or estop to disarmed",
         "Arm it again afterwards.");
}

}  // namespace sinew::tools

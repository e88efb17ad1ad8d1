#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/json_text.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/ownership.h"
#include "components/topics/node/time_option.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"

namespace sinew::tools {

namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kRepeatHandover(
    200);  // the command is volatile: said again until it is done

// It is heard for so long, some deadlines of an owner (node/ownership.h), before it counts: one
// that has just begun may miss one, and is replaced.
constexpr milliseconds kHeardFor(100);

struct HandoverOptions {
  node::Options node;
  std::string role, target;
  double timeout_s = 5.0;
  bool json = false;
};

// The EXCLUSIVE topics of a participant, and whether it is the one that is heard of each.
std::map<std::string, bool> TopicsOf(const node::Node& node, const std::string& participant) {
  std::map<std::string, std::uint32_t> own, others;
  for (const node::Endpoint& endpoint : node.Endpoints()) {
    const node::TopicInfo* info = node::FindTopic(endpoint.topic);
    if (!endpoint.is_writer || info == nullptr || !node::IsExclusive(info->profile)) continue;
    auto& strengths = endpoint.participant == participant ? own : others;
    std::uint32_t& strength = strengths[endpoint.topic];
    strength = std::max(strength, endpoint.strength);
  }
  std::map<std::string, bool> heard;
  for (const auto& [topic, strength] : own) {
    heard[topic] = node::HasSettled(strength) && strength > others[topic];
  }
  return heard;
}

bool HeardOfAll(const std::map<std::string, bool>& topics) {
  return !topics.empty() &&
         std::all_of(topics.begin(), topics.end(), [](const auto& topic) { return topic.second; });
}

class Handover {
 public:
  explicit Handover(const HandoverOptions& options)
      : options_(options),
        node_(options.node),
        states_(node_.MakeReader(node::kJointState)),
        statuses_(node_.MakeReader(node::kComponentStatus)),
        sources_(node_.MakeReader(node::kCommandSource)),
        commands_(node_.MakeWriter(node::kOperatorCommand)) {}

  // Empty: done. Else why not.
  std::string Run() {
    const auto end = Clock::now() + std::chrono::duration<double>(options_.timeout_s);
    auto next_send = Clock::now();
    bool sent = false;
    std::optional<Clock::time_point> heard_since;
    while (Clock::now() < end) {
      Listen();
      if (std::string why = NotToBe(); !why.empty()) return why;
      // Strengths alone do not say it: the others may not have been discovered yet, and who was
      // silent for a moment went below them again.
      const std::map<std::string, bool> topics = TopicsOf(node_, options_.target);
      if (!sent || target_->standby || !HeardOfAll(topics) || !Obeyed(topics)) {
        heard_since.reset();
      } else if (!heard_since) {
        heard_since = Clock::now();
      } else if (Clock::now() - *heard_since >= kHeardFor) {
        return "";
      }
      if (state_ && target_ && commands_.matched_readers() > 0 && Clock::now() >= next_send) {
        sent = Send() || sent;
        next_send = Clock::now() + kRepeatHandover;
      }
      node_.WaitForData(milliseconds(20));
    }
    const std::string domain = " in domain " + std::to_string(options_.node.domain_id);
    if (!target_) return "no participant '" + options_.target + "'" + domain;
    if (!state_) return "no state provider" + domain;
    if (!sent) return "the command reached nobody";
    const std::string why = HeardOfAll(TopicsOf(node_, options_.target))
                                ? ", though no writer is stronger: the state provider obeys another"
                                : "";
    return "'" + options_.target + "' did not take over" + why + "; see its log";
  }

  std::vector<std::string> topics() const {
    std::vector<std::string> names;
    for (const auto& [topic, heard] : TopicsOf(node_, options_.target)) names.push_back(topic);
    return names;
  }

 private:
  void Listen() {
    if (auto newest = states_.TakeLatest()) state_ = newest;
    if (auto newest = sources_.TakeLatest()) source_ = std::move(newest);
    while (auto status = statuses_.TakeNext()) {
      if (status->name == options_.target) target_ = *status;
    }
  }

  // By the state provider's word, which it gives of these two topics. It counts: each reader
  // decides by itself whom it hears.
  bool Obeyed(const std::map<std::string, bool>& topics) const {
    const msg::CommandSource source = source_.value_or(msg::CommandSource());
    const auto by = [&](std::string_view topic, const std::string& participant) {
      return !topics.contains(std::string(topic)) || participant == options_.target;
    };
    return by(node::kJointCommand.name, source.joint_command_participant) &&
           by(node::kValveCommand.name, source.valve_command_participant);
  }

  // A reason against the handover that no waiting changes; empty: none.
  std::string NotToBe() const {
    if (!target_) return "";
    const std::string kind = target_->component_kind;
    if (kind != options_.role) {
      return "'" + options_.target + "' has the role '" + kind + "', not '" + options_.role + "'";
    }
    if (target_->state == msg::ComponentState::kFault) {
      return "'" + options_.target + "' is in fault: " + target_->message;
    }
    return "";
  }

  bool Send() {
    msg::OperatorCommand command;
    command.header = state_->header;
    command.action = msg::OperatorAction::kHandover;
    command.reason = "handover";
    command.role = options_.role;
    command.target = options_.target;
    return commands_.Write(command) == node::WriteStatus::kOk;
  }

  const HandoverOptions& options_;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::ComponentStatus> statuses_;
  node::Reader<msg::CommandSource> sources_;
  node::Writer<msg::OperatorCommand> commands_;
  std::optional<msg::JointState> state_;
  std::optional<msg::ComponentStatus> target_;
  std::optional<msg::CommandSource> source_;
};

void RunHandover(const HandoverOptions& options) {
  Handover handover(options);
  const auto began = Clock::now();
  const std::string why = handover.Run();
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  if (options.json) {
    nlohmann::ordered_json report = {{"role", options.role},
                                     {"target", options.target},
                                     {"done", why.empty()},
                                     {"topics", handover.topics()}};
    if (!why.empty()) report["why"] = why;
    std::cout << types::JsonText(report) << '\n';
  } else if (why.empty()) {
    std::cout << "'" << options.target << "' is heard as " << options.role << " after "
              << static_cast<int>(1e3 * seconds) << " ms:";
    for (const std::string& topic : handover.topics()) std::cout << ' ' << topic;
    std::cout << '\n';
  }
  if (why.empty()) return;
  std::cerr << "sinew handover: " << why << '\n';
  throw CLI::RuntimeError(1);
}

}  // namespace

void AddHandoverCommand(CLI::App& app) {
  auto options = std::make_shared<HandoverOptions>();
  CLI::App* command = app.add_subcommand(
      "handover", "Another participant of a role takes over while the robot runs");
  AddNodeOptions(*command, &options->node);
  command->add_option("role", options->role, "The kind of participant, e.g. control")->required();
  command->add_option("name", options->target, "The participant that takes over")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name.size() <= 64 ? "" : "a name of at most 64 characters is expected";
          },
          ""));
  command->add_option("--timeout", options->timeout_s, "Seconds to wait until it is heard")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "Both run; the one that takes over was started later, or came back after it had failed, and "
      "stands by.\nExit code 1 when it was not heard in time.\n\nExample:\n  sinew-control "
      "--config control.yaml --name control_b &\n  sinew handover control control_b");
  command->callback([options] { RunHandover(*options); });
}

}  // namespace sinew::tools

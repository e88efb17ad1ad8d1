#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>

#include "components/base/types/json_text.h"
#include "components/base/types/robot_state.h"
#include "components/topics/isolation/isolation.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/node_options.h"

namespace sinew::tools {

namespace {

using PermitClock = std::chrono::steady_clock;
using std::chrono::milliseconds;

// The command is volatile: said again until a component says that it has it, and then as often that
// standbys whose discovery is still under way get it.
constexpr int kPermitRepeats = 5;
constexpr milliseconds kPermitRepeat(100);

struct PermitOptions {
  node::Options node;
  std::string target, reason;
  double timeout_s = 5.0;
  bool json = false;
};

// Participant whose reference is heard: its writer has the greatest strength. Empty: nobody yet.
std::string HeardReference(const node::Node& node) {
  std::string heard;
  std::uint32_t greatest = 0;
  for (const node::Endpoint& endpoint : node.Endpoints()) {
    const node::TopicInfo* info = node::FindTopic(endpoint.topic);
    if (!endpoint.is_writer || info == nullptr || info->name != node::kReference.name) continue;
    if (!heard.empty() && endpoint.strength <= greatest) continue;
    heard = endpoint.participant;
    greatest = endpoint.strength;
  }
  return heard;
}

class Permit {
 public:
  explicit Permit(const PermitOptions& options)
      : options_(options),
        node_(options.node),
        states_(node_.MakeReader(node::kJointState)),
        statuses_(node_.MakeReader(node::kComponentStatus)),
        commands_(node_.MakeWriter(node::kOperatorCommand)) {}

  // Empty: permitted. Else why not.
  std::string Run() {
    const auto end = PermitClock::now() + std::chrono::duration<double>(options_.timeout_s);
    auto next_send = PermitClock::now();
    int sent = 0;
    while (PermitClock::now() < end) {
      Listen();
      const bool ready = Why().empty() && commands_.matched_readers() > 0;
      if (ready && PermitClock::now() >= next_send) {
        sent += Send() ? 1 : 0;
        next_send = PermitClock::now() + kPermitRepeat;
      }
      if (sent >= kPermitRepeats && !permitting_.empty()) return "";
      node_.WaitForData(milliseconds(20));
    }
    std::string why = Why();
    if (!why.empty()) return why;
    if (sent == 0) return "the command reached nobody";
    return "no component says that it permits it; the log of control has the reason";
  }

 private:
  void Listen() {
    if (auto newest = states_.TakeLatest()) state_ = newest;
    while (const auto status = statuses_.TakeNext()) {
      if (status->permitted_replay == options_.target) {
        permitting_.insert(status->name);
      } else {
        permitting_.erase(status->name);
      }
    }
  }

  std::string Why() const {
    const std::string domain = " in domain " + std::to_string(options_.node.domain_id);
    if (!state_) {
      return "no state provider heard" + domain + isolation::OthersIn(options_.node.domain_id);
    }
    const std::string heard = HeardReference(node_);
    if (heard != options_.target) {
      return "'" + options_.target + "' is not the one whose reference is heard" + domain +
             (heard.empty() ? "" : ", that is '" + heard + "'");
    }
    if (!types::MayMove(state_->robot_state)) {
      return "the robot is not armed; the permission ends with every disarm, so arm it first";
    }
    return "";
  }

  bool Send() {
    msg::OperatorCommand command;
    command.header = state_->header;
    command.action = msg::OperatorAction::kPermitReplay;
    command.reason = options_.reason.substr(0, 63);
    command.target = options_.target;
    return commands_.Write(command) == node::WriteStatus::kOk;
  }

  const PermitOptions& options_;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::ComponentStatus> statuses_;
  node::Writer<msg::OperatorCommand> commands_;
  std::optional<msg::JointState> state_;
  std::set<std::string> permitting_;  // components that say so
};

void RunPermit(const PermitOptions& options) {
  const std::string why = Permit(options).Run();
  if (options.json) {
    nlohmann::ordered_json report = {{"target", options.target}, {"done", why.empty()}};
    if (!why.empty()) report["why"] = why;
    std::cout << types::JsonText(report) << '\n';
  } else if (why.empty()) {
    std::cout << "the recording that '" << options.target
              << "' plays may move the robot until it is disarmed\n";
  }
  if (why.empty()) return;
  std::cerr << "sinew permit-replay: " << why << '\n';
  throw CLI::RuntimeError(1);
}

}  // namespace

void AddPermitReplayCommand(CLI::App& app) {
  auto options = std::make_shared<PermitOptions>();
  CLI::App* command =
      app.add_subcommand("permit-replay", "A recorded reference may move live hardware");
  AddNodeOptions(*command, &options->node);
  command->add_option("name", options->target, "The participant that plays the recording")
      ->required()
      ->check(CLI::Validator(
          [](const std::string& name) {
            return !name.empty() && name.size() <= 64 ? ""
                                                      : "a name of 1 to 64 characters is expected";
          },
          ""));
  command->add_option("--reason", options->reason, "For the logs, 63 characters");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait for robot and player")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->add_flag("--json", options->json, "As JSON");
  command->footer(
      "For this one player, until the robot is disarmed, stopped, in fault or started anew, or "
      "somebody else's\nreference is heard. The joints go from where they are held to the "
      "recording "
      "over replay_takeover_s.\nSimulations need no permission.\nExit code 1 when no component "
      "permitted it in time.\n\nExample:\n  sinew replay run.mcap --topics reference &\n  sinew "
      "arm\n"
      "  sinew permit-replay player");
  command->callback([options] { RunPermit(*options); });
}

}  // namespace sinew::tools

#include <sinew_idl/joint.h>
#include <sinew_idl/snapshot.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "components/base/config/config.h"
#include "components/topics/node/node.h"
#include "components/topics/node/time_option.h"
#include "tools/rerun/command.h"
#include "tools/sinew/node_options.h"

namespace sinew::rerun {
namespace {

using SnapshotClock = std::chrono::steady_clock;

struct SnapshotOptions {
  node::Options node;
  std::string name;
  std::uint64_t after_tick = 0;
  double timeout_s = 5.0;
};

// The first parts that come back name the process. Whole snapshots are the recorder's matter.
class Asker {
 public:
  explicit Asker(const SnapshotOptions& options)
      : options_(options),
        node_(options.node),
        states_(node_.MakeReader(node::kJointState)),
        answers_(node_.MakeReader(node::kComponentSnapshot)),
        requests_(node_.MakeWriter(node::kSnapshotRequest)) {}

  // Names of those that answered: all that do within the time, or the one that was asked.
  std::set<std::string> Ask() {
    const auto end = SnapshotClock::now() + std::chrono::duration<double>(options_.timeout_s);
    std::set<std::string> answered;
    while (SnapshotClock::now() < end) {
      if (auto newest = states_.TakeLatest()) state_ = newest;
      if (!asked_tick_ && state_ && requests_.matched_readers() > 0) Send();
      while (const auto part = answers_.TakeNext()) {
        if (asked_tick_ && part->header.tick >= *asked_tick_) {
          answered.insert(part->name);
        }
      }
      if (answered.contains(options_.name)) break;
      node_.WaitForData(std::chrono::milliseconds(20));
    }
    if (!state_) {
      throw UsageError("no state provider heard in domain " +
                       std::to_string(options_.node.domain_id));
    }
    return answered;
  }

 private:
  void Send() {
    msg::SnapshotRequest request;
    request.header = state_->header;
    request.name = options_.name;
    request.after_tick = options_.after_tick;
    if (requests_.Write(request) == node::WriteStatus::kOk) {
      asked_tick_ = std::max(options_.after_tick, state_->header.tick);
    }
  }

  const SnapshotOptions& options_;
  node::Node node_;
  node::Reader<msg::JointState> states_;
  node::Reader<msg::ComponentSnapshot> answers_;
  node::Writer<msg::SnapshotRequest> requests_;
  std::optional<msg::JointState> state_;
  std::optional<std::uint64_t> asked_tick_;
};

}  // namespace

void AddSnapshotCommand(CLI::App& app) {
  auto options = std::make_shared<SnapshotOptions>();
  CLI::App* command = app.add_subcommand(
      "snapshot", "Ask components for their state, from which a recording can be run again");
  tools::AddNodeOptions(*command, &options->node);
  command->add_option("name", options->name, "Participant; all by default")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return name.size() <= 64 ? "" : "a name of at most 64 characters is expected";
          },
          ""));
  command->add_option("--after", options->after_tick, "Tick; after the next one by default");
  command->add_option("--timeout", options->timeout_s, "Seconds to wait for answers")
      ->check(node::IsTime(node::Zero::kRefused))
      ->capture_default_str();
  command->footer(
      "A recorder that runs writes them into its file; `sinew rerun --from` goes on from there.\n"
      "Exit code 1 when nobody answered in time.\n\n"
      "Examples:\n  sinew snapshot\n  sinew snapshot control --after 7200 --timeout 60");
  command->callback([options] {
    const std::set<std::string> answered = Asker(*options).Ask();
    for (const std::string& name : answered) std::cout << name << '\n';
    if (!answered.empty()) return;
    std::cerr << "sinew snapshot: nobody answered in " << options->timeout_s << " s\n";
    throw CLI::RuntimeError(1);
  });
}

}  // namespace sinew::rerun

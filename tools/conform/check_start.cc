// The program comes up, says who it is, writes what its role writes, and is no owner until it is
// handed over to.
#include <algorithm>
#include <cmath>
#include <csignal>

#include "components/topics/node/endpoint.h"
#include "components/topics/node/ownership.h"
#include "components/topics/node/topics.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kHandover(2000);  // `sinew handover` gives up after 5 s
// A writer settles within kSettleTime of its creation (ownership.h); news of it take half a second
// at most (leaseAnnouncement).
constexpr milliseconds kSettled = node::internal::kSettleTime + milliseconds(500);

// The topics that the program writes and of which one writer is heard, with their strengths.
std::vector<node::Endpoint> OwnedEndpoints(const RealTimeRun& run) {
  std::vector<node::Endpoint> endpoints = run.stage.SubjectEndpoints();
  std::erase_if(endpoints, [](const node::Endpoint& endpoint) {
    const node::TopicInfo* topic = node::FindTopic(endpoint.topic);
    return !endpoint.is_writer || topic == nullptr || !node::IsExclusive(topic->profile);
  });
  return endpoints;
}

struct Strengths {
  std::uint32_t own = 0, owners = 0;
};

// Strengths on each owned topic that the role must write. own: the greatest, because a program may
// keep an old writer of a topic for a moment.
std::vector<Strengths> StrengthsOf(const RealTimeRun& run) {
  std::vector<Strengths> strengths;
  const auto endpoints = OwnedEndpoints(run);
  for (const node::TopicInfo& topic : run.role.must_write) {
    if (!node::IsExclusive(topic.profile)) continue;
    Strengths both{.own = 0, .owners = run.stage.OwnerStrength(topic.name)};
    for (const node::Endpoint& endpoint : endpoints) {
      if (endpoint.topic == topic.name) both.own = std::max(both.own, endpoint.strength);
    }
    strengths.push_back(both);
  }
  return strengths;
}

std::string StrengthText(const std::vector<Strengths>& strengths) {
  std::string text;
  for (const Strengths& both : strengths) {
    text += (text.empty() ? "strength " : ", ") + std::to_string(both.own) +
            " beside the owner's " + std::to_string(both.owners);
  }
  return text;
}

}  // namespace

void CheckStart(RealTimeRun& run) {
  const auto began = StageClock::now();
  const auto is_up = [&] {
    const auto status = run.stage.status();
    return status && run.stage.SubjectReads(node::kJointState.name) &&
           std::all_of(
               run.role.must_write.begin(), run.role.must_write.end(),
               [&](const node::TopicInfo& topic) { return run.stage.SubjectWrites(topic.name); });
  };
  const bool up = run.stage.PlayUntil(run.Disarmed(), is_up, kStart);
  const double seconds = std::chrono::duration<double>(StageClock::now() - began).count();
  const bool active = up && run.stage.PlayUntil(
                                run.Disarmed(),
                                [&] {
                                  const auto status = run.stage.status();
                                  return status && status->state == msg::ComponentState::kActive;
                                },
                                kStart);
  const auto status = run.stage.status();
  std::string seen;
  if (!status) {
    seen = "no component_status of '" + run.stage.options().subject + "'";
  } else {
    seen = NameOf(status->state);
    if (!status->message.empty()) seen += ": " + status->message;
    for (const node::TopicInfo& topic : run.role.must_write) {
      if (!run.stage.SubjectWrites(topic.name)) seen += "; no writer of " + topic.name;
    }
    if (!run.stage.SubjectReads(node::kJointState.name)) seen += "; no reader of joint_state";
    if (up) seen += ", ready after " + std::to_string(std::lround(1e3 * seconds)) + " ms";
  }
  const int exit_code = run.program.Wait(milliseconds(0));
  if (exit_code != launch::Program::kTimeout) {
    seen += "; " + EndText(exit_code) + ": " + LastLine(run.program);
  }
  run.report.Add("start", active,
                 "component_status of its name, active within " + std::to_string(kStart.count()) +
                     " ms of ticks, a reader of joint_state and a writer of each of its topics",
                 seen);
  const std::string kind = status ? status->component_kind : "";
  run.report.Add("kind", kind == run.role.name, "component_kind '" + run.role.name + "'",
                 "'" + kind + "'");
  const std::string hash = status ? status->idl_hash : "";
  run.report.Add("idl_hash", hash == node::AllTopicsHash(),
                 "idl_hash " + node::AllTopicsHash() + " of this build's topics", "'" + hash + "'");
}

void CheckOwnership(RealTimeRun& run) {
  if (!run.role.has_owned_topics()) {
    run.report.Skip("joins_below", "no topic of the role has owners");
    run.report.Skip("handover", "no topic of the role has owners");
    return;
  }
  std::vector<Strengths> strengths;
  const auto any_of = [&](auto condition) {
    strengths = StrengthsOf(run);
    return std::any_of(strengths.begin(), strengths.end(), condition);
  };
  const auto is_above = [](const Strengths& both) { return both.own > both.owners; };
  const auto is_level = [](const Strengths& both) { return both.own == both.owners; };
  // Until the program has settled, and a little longer. At no moment above the owner: one that has
  // taken over and is stalled after that is below again.
  const bool rose = run.stage.PlayUntil(
      run.Disarmed(), [&] { return any_of(is_above); }, kSettled);
  run.report.Add("joins_below", !rose && !any_of(is_level),
                 "a writer that is started later has a strength below the owner's",
                 StrengthText(strengths));

  const auto above = [&] {
    strengths = StrengthsOf(run);
    return std::all_of(strengths.begin(), strengths.end(), is_above);
  };
  bool taken = false;
  const auto end = StageClock::now() + kHandover;
  while (!taken && StageClock::now() < end) {
    run.stage.Send(msg::OperatorAction::kHandover, run.stage.options().subject);
    taken = run.stage.PlayUntil(run.Disarmed(), above, milliseconds(200));
  }
  run.report.Add("handover", taken,
                 "OPERATOR_HANDOVER with its role, name and session raises its strength above the "
                 "owner's within " +
                     std::to_string(kHandover.count()) + " ms",
                 StrengthText(strengths));
}

void CheckTypes(RealTimeRun& run) {
  std::string missing, foreign_types, others;
  std::string writes;
  for (const node::TopicInfo& topic : run.role.must_write) {
    if (!run.stage.SubjectWrites(topic.name)) missing += " " + topic.name;
  }
  for (const node::Endpoint& endpoint : run.stage.SubjectEndpoints()) {
    const node::TopicInfo* topic = node::FindTopic(endpoint.topic);
    if (topic != nullptr && endpoint.type_name != topic->dds_type_name) {
      foreign_types += " " + endpoint.topic + ": " + endpoint.type_name + ", expected " +
                       topic->dds_type_name + ";";
    }
    if (!endpoint.is_writer) continue;
    writes += " " + endpoint.topic;
    const bool of_all =
        endpoint.topic == node::kComponentStatus.name || endpoint.topic == node::kLog.name;
    if (!of_all && !run.role.Writes(endpoint.topic)) {
      others += " " + endpoint.topic;
    }
  }
  run.report.Add("writes_its_topics", missing.empty(),
                 "a writer of each topic that the role writes (idl/README.md)",
                 missing.empty() ? "writes" + writes : "no writer of" + missing);
  run.report.Add("types", foreign_types.empty(),
                 "every type has its name and the hash of its IDL (docs/decisions/0002)",
                 foreign_types.empty() ? "as this build's" : foreign_types.substr(1));
  run.report.Add("no_other_topics", others.empty(), "no writer of a topic of another role",
                 others.empty() ? "none" : "writes" + others);

  std::string unmatched, problems;
  for (const node::TopicInfo& topic : run.role.must_write) {
    if (!run.stage.IsHeard(topic.name)) unmatched += " " + topic.name;
  }
  for (const std::string& problem : run.stage.node().Problems()) {
    problems += (problems.empty() ? "" : "; ") + problem;
  }
  if (!unmatched.empty()) problems += "; not matched:" + unmatched;
  run.report.Add("qos", problems.empty(),
                 "writers and readers match with the QoS of idl/README.md, ownership included",
                 problems.empty() ? "all match" : problems);
}

void CheckSigterm(RealTimeRun& run) {
  run.program.Signal(SIGTERM);
  const auto end = StageClock::now() + kEnd;
  int exit_code = launch::Program::kTimeout;
  (void)run.stage.PlayUntil(
      run.Disarmed(),
      [&] {
        exit_code = run.program.Wait(milliseconds(0));
        return exit_code != launch::Program::kTimeout || StageClock::now() > end;
      },
      kEnd);
  run.report.Add("sigterm", exit_code == 0,
                 "exit code 0 within " + std::to_string(kEnd.count()) + " ms of SIGTERM",
                 EndText(exit_code));
}

}  // namespace sinew::conform

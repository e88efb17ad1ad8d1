#include "tools/roles/roles.h"

#include <algorithm>
#include <map>
#include <set>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/topics/node/topic_parties.h"
#include "components/topics/node/topics.h"

namespace sinew::security {

namespace {

struct Role {
  std::string_view name, purpose;
  std::vector<std::string_view> parties;  // of the table's writers
};

const std::vector<Role>& Roles() {
  static const std::vector<Role> kRoles = {
      {"provider",
       "the state provider: world, surrogate or CAN bridge",
       {"state provider", "state provider with feet", "state provider with a torso", "can_bridge",
        "world", "surrogate"}},
      {"control", "the controller", {"control"}},
      {"reference", "the reference, also a recorded one", {"reference"}},
      {"regime", "the regime detector", {"regime"}},
      {"pneumatics", "pressure and valves", {"pneumatics"}},
      {"esn", "the torque prediction", {"esn"}},
      {"rls", "the adaptation of the readout", {"rls"}},
      {"residual", "the residual monitor", {"residual"}},
      {"performance", "the performance monitor", {"performance"}},
      {"virtual_axes", "the simulation behind a CAN bridge", {"virtual_axes"}},
      {"operator",
       "arm, disarm, estop, reset, handover, permissions, snapshots; the page of sinew-view",
       {"operator", "sinew arm", "disarm", "estop", "reset", "permit-replay", "sinew-view",
        "sinew snapshot"}},
      {"estop", "the estop's program", {"sinew-estop"}},
      {"experiment",
       "requests of experiments, and disturbances of a simulation",
       {"experiments", "sinew-body-disturbance"}},
      {"observer", "list, echo, log, hz, graph, doctor, record: its status and log alone", {}},
      {"logger", "the logger", {"logger"}},
      {"player", "a recording again: every topic that cannot move a robot", {}},
  };
  return kRoles;
}

const Role* FindRole(std::string_view name) {
  const auto found = std::find_if(Roles().begin(), Roles().end(),
                                  [name](const Role& role) { return role.name == name; });
  return found == Roles().end() ? nullptr : &*found;
}

// Programs whose name is not that of their role.
const std::map<std::string, std::string, std::less<>> kPrograms = {
    {"sinew-world", "provider"},
    {"sinew-surrogate", "provider"},
    {"sinew-can-bridge", "provider"},
    {"sinew-can-bus", "observer"},  // no topics
    {"sinew-ideal-pressure", "pneumatics"},
    {"sinew-regime-truth", "regime"},
    {"sinew-recorded-reference", "reference"},
    {"sinew-frozen-readout", "rls"},
    {"sinew-inverse-dynamics", "esn"},
    {"sinew-body-disturbance", "experiment"},
    {"sinew-view", "operator"}};

constexpr std::string_view kEverybody = "all";

}  // namespace

std::vector<std::string> RoleNames() {
  std::vector<std::string> names;
  for (const Role& role : Roles()) names.emplace_back(role.name);
  return names;
}

std::string_view PurposeOf(const std::string& role) {
  const Role* found = FindRole(role);
  return found == nullptr ? std::string_view() : found->purpose;
}

std::vector<std::string> TopicsWrittenBy(const std::vector<std::string>& roles) {
  std::set<std::string> topics;
  const std::vector<std::string> commanding = CommandingTopics();
  for (const std::string& name : roles) {
    const Role* role = FindRole(name);
    if (role == nullptr) {
      throw UsageError("no role '" + name + "', expected one of: " + types::Joined(RoleNames()));
    }
    for (const node::TopicParty& row : node::kTopicParties) {
      if (row.access != node::Access::kWrites) continue;
      const auto& parties = role->parties;
      const bool its_own = row.party == kEverybody ||
                           std::find(parties.begin(), parties.end(), row.party) != parties.end();
      const bool played = name == "player" && std::find(commanding.begin(), commanding.end(),
                                                        row.topic) == commanding.end();
      if (its_own || played) topics.emplace(row.topic);
    }
  }
  return {topics.begin(), topics.end()};
}

std::vector<std::string> CommandingTopics() {
  std::vector<std::string> topics(node::kCommandingTopics.begin(), node::kCommandingTopics.end());
  topics.emplace_back(node::kEstopState.name);
  return topics;
}

std::string RoleOfProgram(const std::string& program) {
  if (const auto found = kPrograms.find(program); found != kPrograms.end()) return found->second;
  constexpr std::string_view kOurs = "sinew-";
  if (!program.starts_with(kOurs)) return {};
  std::string role = program.substr(kOurs.size());
  std::replace(role.begin(), role.end(), '-', '_');
  return FindRole(role) == nullptr ? std::string() : role;
}

std::vector<std::string> PartiesWithoutRole() {
  std::set<std::string> left;
  for (const node::TopicParty& row : node::kTopicParties) {
    if (row.access == node::Access::kWrites && row.party != kEverybody) left.emplace(row.party);
  }
  for (const Role& role : Roles()) {
    for (const std::string_view party : role.parties) left.erase(std::string(party));
  }
  return {left.begin(), left.end()};
}

}  // namespace sinew::security

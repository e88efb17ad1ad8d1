#include "tools/conform/role.h"

#include <algorithm>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "components/topics/node/topic_parties.h"

namespace sinew::conform {

namespace {

// Parties of the table that answer every tick of a robot that others play. A state provider makes
// the ticks itself, a logger writes files.
constexpr std::string_view kRoles[] = {"pneumatics", "regime",  "reference", "esn",
                                       "rls",        "control", "residual",  "performance"};

constexpr StaleRule kStaleRules[] = {
    // docs/participants/control.md, "When an input is missing"
    {"control", "reference", "joint_command"},
    {"control", "actuator_state", "joint_command"},
    {"control", "torque_prediction", "joint_command"},
    {"control", "regime", "joint_command"},
    // docs/participants/esn.md, "An input is old or lost"
    {"esn", "reference", "torque_prediction"},
    {"esn", "actuator_state", "torque_prediction"},
    {"esn", "regime", "torque_prediction"},
    // docs/participants/regime.md, "Unknown"; docs/participants/stand_ins.md, "True regime"
    {"regime", "actuator_state", "regime"},
    {"regime", "sim_truth", "regime"},
    // docs/participants/rls.md, "When it learns nothing"
    {"rls", "reservoir_state", "adaptation_state"},
    {"rls", "joint_command", "adaptation_state"},
    {"rls", "actuator_state", "adaptation_state"},
    // docs/participants/pneumatics.md, "Lost samples are no fault"
    {"pneumatics", "actuator_state", "pneumatic_state"},
    // docs/participants/residual.md, state LOST
    {"residual", "actuator_state", "residual"},
    // docs/participants/performance.md, "Lost samples"
    {"performance", "reference", "performance"},
};

bool Contains(const std::vector<node::TopicInfo>& topics, std::string_view name) {
  return std::any_of(topics.begin(), topics.end(),
                     [name](const node::TopicInfo& topic) { return topic.name == name; });
}

}  // namespace

std::span<const StaleRule> StaleRules() { return kStaleRules; }

bool Role::Writes(std::string_view topic) const {
  return Contains(must_write, topic) || Contains(may_write, topic);
}

bool Role::has_owned_topics() const {
  return std::any_of(must_write.begin(), must_write.end(),
                     [](const node::TopicInfo& topic) { return node::IsExclusive(topic.profile); });
}

std::vector<std::string> RoleNames() { return {std::begin(kRoles), std::end(kRoles)}; }

Role FindRole(const std::string& name) {
  if (std::find(std::begin(kRoles), std::end(kRoles), name) == std::end(kRoles)) {
    throw UsageError("no role '" + name + "', expected one of: " + types::Joined(kRoles));
  }
  Role role;
  role.name = name;
  for (const node::TopicParty& row : node::kTopicParties) {
    if (row.party != name || row.access != node::Access::kWrites) continue;
    (row.always ? role.must_write : role.may_write).push_back(*node::FindTopic(row.topic));
  }
  role.commands_joints = role.Writes(node::kJointCommand.name);
  return role;
}

}  // namespace sinew::conform

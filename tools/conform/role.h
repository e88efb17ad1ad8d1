// The roles that a program may take, and what the contract of each says: which topics it writes,
// from the table in idl/README.md, and which of its outputs reports which lost input, from
// docs/participants.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "components/topics/node/topics.h"

namespace sinew::conform {

// An input whose loss an output reports: `stale`, or of pneumatic_state that nothing is settled.
struct StaleRule {
  std::string_view role, input, output;
};
std::span<const StaleRule> StaleRules();

struct Role {
  std::string name;
  std::vector<node::TopicInfo> must_write;  // every tick
  std::vector<node::TopicInfo> may_write;   // under a condition of the table
  bool commands_joints = false;             // writes joint_command

  bool Writes(std::string_view topic) const;  // must or may
  // One writer of it is heard at a time.
  bool has_owned_topics() const;
};

// Those that `sinew conform` knows: every party of the table that is a role and answers every tick.
std::vector<std::string> RoleNames();

// Throws UsageError, which lists the names.
Role FindRole(const std::string& name);

}  // namespace sinew::conform

// Members that get a certificate when a deployment gets its keys: its processes, and the people and
// programs that come to it from outside.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/launch/deployment.h"
#include "tools/security/folder.h"

namespace sinew::security {

// A certificate each for an operator, an observer, a logger and a player, where no process has that
// name; one for each process with the role of its program, or those of `roles` (by its name).
// A process of a deployment over several hosts belongs on its own, the others on `host`. Plain
// processes have none unless they are in `roles`. Throws UsageError for a program whose role is not
// known, and for names in `roles` that are no process.
std::vector<Member> MembersOf(const launch::Deployment& deployment,
                              const std::map<std::string, std::vector<std::string>>& roles,
                              const std::string& host);

}  // namespace sinew::security

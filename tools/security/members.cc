#include "tools/security/members.h"

#include <algorithm>

#include "components/base/config/config.h"
#include "components/base/types/joined.h"
#include "tools/roles/roles.h"

namespace sinew::security {

std::vector<Member> MembersOf(const launch::Deployment& deployment,
                              const std::map<std::string, std::vector<std::string>>& roles,
                              const std::string& host) {
  for (const auto& [name, of_name] : roles) {
    if (deployment.Find(name) == nullptr) {
      throw UsageError("--role " + name + "=" + types::Joined(of_name, ",") +
                       ": expected a process of " + deployment.file.string());
    }
  }
  std::vector<Member> members;
  for (const launch::Process& process : deployment.processes) {
    Member member{process.name, {}, process.host.empty() ? host : process.host};
    if (const auto given = roles.find(process.name); given != roles.end()) {
      member.roles = given->second;
    } else if (process.plain) {
      continue;
    } else if (process.name == deployment.provider) {
      member.roles = {"provider"};
    } else {
      const std::string program = process.program.filename().string();
      const std::string role = RoleOfProgram(program);
      if (role.empty()) {
        throw UsageError("process '" + process.name + "': the role of " + program +
                         " is not known, expected --role " + process.name + "=ROLE, of " +
                         types::Joined(RoleNames()));
      }
      member.roles = {role};
    }
    members.push_back(std::move(member));
  }
  for (const char* role : {"operator", "observer", "logger", "player"}) {
    const auto same = std::find_if(members.begin(), members.end(),
                                   [role](const Member& member) { return member.name == role; });
    if (same == members.end()) {
      members.push_back({role, {role}, host});
    } else if (same->roles != std::vector<std::string>{role}) {
      throw UsageError("process '" + same->name + "' has the role " + types::Joined(same->roles) +
                       ", expected another name: this one is of the certificate with that role");
    }
  }
  return members;
}

}  // namespace sinew::security

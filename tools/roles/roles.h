// Roles of certificates, and the topics that each may write: from the table in idl/README.md.
//
// A role is a party of the table's writers, or several that are one in practice. A certificate may
// have several roles. Every certificate may write component_status and log, and read every topic:
// reading moves nothing. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace sinew::security {

// In the order of the documentation.
std::vector<std::string> RoleNames();
// One line for users.
std::string_view PurposeOf(const std::string& role);

// The topics that a certificate with these roles may write, sorted. Throws UsageError for a role
// that is none.
std::vector<std::string> TopicsWrittenBy(const std::vector<std::string>& roles);

// Those whose payload is encrypted as well: commanding topics, and estop_state, without which a
// robot is not armed.
std::vector<std::string> CommandingTopics();

// The role of a program of ours ("sinew-esn" and its stand-ins: esn); empty: none is known.
std::string RoleOfProgram(const std::string& program);

// Parties of the table's writers that belong to no role: none, and a test says so.
std::vector<std::string> PartiesWithoutRole();

}  // namespace sinew::security

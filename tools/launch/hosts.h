// The hosts of a deployment (key `hosts` of its file), and which of them this machine is.
//
// Set-up only; throws UsageError with one line.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "components/base/config/fields.h"

namespace sinew::launch {

struct Host {
  std::string name;
  std::string interface;  // to the others, by the name that it has there
  std::string user;       // whose processes run there; empty: any
};

// --host of a run with the processes of all hosts on this machine, on loopback.
inline constexpr char kAllHosts[] = "all";

// In the order of the file; none: the deployment is of one host.
void DescribeHosts(config::Fields& fields, std::vector<Host>* hosts);

// The host that `chosen` (--host) names, or where that is empty, this machine by its name, with or
// without its domain; nullptr: all. Throws: neither is one of them, or there is no such interface.
const Host* HostHere(const std::vector<Host>& hosts, const std::filesystem::path& file,
                     const std::string& chosen);

// Throws when this process is of another user than the host's.
void RequireUser(const Host& host, const std::filesystem::path& file);

// Names of this machine's interfaces, as text for messages.
std::string InterfaceNames();
// Empty: every name is an interface of this machine.
std::string UnknownInterface(const std::vector<std::string>& names);

}  // namespace sinew::launch

#include "tools/launch/hosts.h"

#include <net/if.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>

#include "components/base/types/joined.h"
#include "components/topics/node/host_name.h"

namespace sinew::launch {

namespace {

bool IsHostName(const std::string& name) {
  return !name.empty() && name.size() <= 63 && name != kAllHosts &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
         });
}

const Host* Find(const std::vector<Host>& hosts, const std::string& name) {
  const auto at = std::find_if(hosts.begin(), hosts.end(),
                               [&name](const Host& host) { return host.name == name; });
  return at == hosts.end() ? nullptr : &*at;
}

std::string NamesOf(const std::vector<Host>& hosts) {
  std::vector<std::string> names;
  names.reserve(hosts.size());
  for (const Host& host : hosts) names.push_back(host.name);
  return types::Joined(names);
}

std::string UserName() {
  const passwd* entry = ::getpwuid(::geteuid());
  return entry != nullptr ? entry->pw_name : std::to_string(::geteuid());
}

}  // namespace

void DescribeHosts(config::Fields& f, std::vector<Host>* hosts) {
  f.List("hosts", {}, "of a deployment over several", [hosts](config::Fields& g) {
    Host host;
    g.Need("name", host.name, "as the machine calls itself");
    g.Need("interface", host.interface, "to the others, by the name that it has there");
    g("user", host.user, "whose processes run there; left out: any");
    g.Require(IsHostName(host.name), "name",
              "'" + host.name + "', expected a host's name, and not '" + kAllHosts +
                  "': letters, digits, '_', '-' or '.'");
    g.Require(!host.interface.empty(), "interface",
              "'', expected the name of its interface to the other hosts");
    g.Require(Find(*hosts, host.name) == nullptr, "name",
              "'" + host.name + "' given twice, expected a name of its own");
    hosts->push_back(std::move(host));
  });
}

const Host* HostHere(const std::vector<Host>& hosts, const std::filesystem::path& file,
                     const std::string& chosen) {
  if (chosen == kAllHosts) return nullptr;
  if (hosts.empty()) {
    if (chosen.empty()) return nullptr;
    throw UsageError("--host " + chosen + ": " + file.string() +
                     " has no 'hosts', expected a deployment over several");
  }
  const std::string machine = node::HostName();
  const Host* here = Find(hosts, chosen.empty() ? machine : chosen);
  if (here == nullptr && chosen.empty()) here = Find(hosts, machine.substr(0, machine.find('.')));
  if (here == nullptr) {
    const std::string what = chosen.empty() ? file.string() + ": hosts: this machine, '" + machine +
                                                  "', is none of them, expected --host with"
                                            : "--host " + chosen + ": expected";
    throw UsageError(what + " one of " + NamesOf(hosts) + ", or " + kAllHosts);
  }
  if (!UnknownInterface({here->interface}).empty()) {
    throw UsageError(file.string() + ": hosts: " + here->name + ": no interface '" +
                     here->interface + "' on this machine, expected one of " + InterfaceNames());
  }
  return here;
}

void RequireUser(const Host& host, const std::filesystem::path& file) {
  if (host.user.empty() || host.user == UserName()) return;
  throw UsageError(file.string() + ": hosts: " + host.name + ": its processes are of user '" +
                   host.user + "', this is '" + UserName() + "', expected sudo -u " + host.user +
                   " sinew launch ...");
}

std::string InterfaceNames() {
  std::string names;
  struct if_nameindex* list = ::if_nameindex();
  if (list == nullptr) return "none can be listed";
  for (const struct if_nameindex* entry = list; entry->if_index != 0; ++entry) {
    names += (names.empty() ? "" : ", ") + std::string(entry->if_name);
  }
  ::if_freenameindex(list);
  return names;
}

std::string UnknownInterface(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    if (::if_nametoindex(name.c_str()) == 0) return name;
  }
  return {};
}

}  // namespace sinew::launch

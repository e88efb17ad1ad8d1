#include "components/topics/node/interfaces.h"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <netinet/in.h>

#include <algorithm>
#include <memory>

#include "components/base/config/config.h"

namespace sinew::node::internal {

namespace {

constexpr char kLoopbackAddress[] = "127.0.0.1";  // the one that Fast DDS rewrites local peers to

std::string RunningNames(const std::vector<InterfaceAddress>& running) {
  std::string text;
  for (const InterfaceAddress& entry : running) {
    text += (text.empty() ? "" : ", ") + entry.interface + " (" + entry.address + ")";
  }
  return text.empty() ? "none is running" : text;
}

}  // namespace

std::uint32_t NumberOf(const std::string& address) {
  in_addr out{};
  return ::inet_pton(AF_INET, address.c_str(), &out) == 1 ? ntohl(out.s_addr) : 0;
}

bool IsOfNetwork(const InterfaceAddress& interface, std::uint32_t address) {
  return ((NumberOf(interface.address) ^ address) & interface.mask) == 0;
}

std::vector<InterfaceAddress> RunningInterfaces() {
  std::vector<InterfaceAddress> running;
  ifaddrs* list = nullptr;
  if (::getifaddrs(&list) != 0) return running;
  const std::unique_ptr<ifaddrs, decltype(&::freeifaddrs)> owner(list, &::freeifaddrs);
  for (const ifaddrs* entry = list; entry != nullptr; entry = entry->ifa_next) {
    if (entry->ifa_addr == nullptr || entry->ifa_addr->sa_family != AF_INET) continue;
    if ((entry->ifa_flags & IFF_RUNNING) == 0) continue;
    char text[INET_ADDRSTRLEN] = {};
    const auto* address = reinterpret_cast<const sockaddr_in*>(entry->ifa_addr);
    if (::inet_ntop(AF_INET, &address->sin_addr, text, sizeof(text)) == nullptr) continue;
    const auto* mask = reinterpret_cast<const sockaddr_in*>(entry->ifa_netmask);
    running.push_back(
        {entry->ifa_name, text, mask == nullptr ? 0xffffffff : ntohl(mask->sin_addr.s_addr)});
  }
  return running;
}

std::vector<InterfaceAddress> AllowedAddresses(const std::vector<std::string>& names,
                                               const std::vector<InterfaceAddress>& running) {
  std::vector<InterfaceAddress> allowed;
  const auto add = [&allowed](const InterfaceAddress& entry) {
    const bool known = std::any_of(allowed.begin(), allowed.end(), [&entry](const auto& other) {
      return other.address == entry.address;
    });
    if (!known) allowed.push_back(entry);
  };
  for (const InterfaceAddress& entry : running) {
    if (entry.address == kLoopbackAddress) add(entry);
  }
  if (allowed.empty()) {
    throw UsageError("loopback is down: expected 127.0.0.1 on lo (ip link set lo up)");
  }
  for (const std::string& name : names) {
    bool found = false;
    for (const InterfaceAddress& entry : running) {
      if (entry.interface != name) continue;
      found = true;
      add(entry);
    }
    if (!found) {
      throw UsageError("--interface " + name +
                       ": no running interface with an IPv4 address, expected one of " +
                       RunningNames(running));
    }
  }
  return allowed;
}

bool IsLoopback(const std::string& address) { return address.rfind("127.", 0) == 0; }

}  // namespace sinew::node::internal

// The addresses that a participant sends from and listens on: loopback, and the interfaces that the
// user named. Nobody on a network can command the robot unless somebody named that network.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace sinew::node::internal {

struct InterfaceAddress {
  std::string interface;  // e.g. "eth0"
  std::string address;    // IPv4, dotted
  // The mask of its network, as a number whose upper byte is the first; by default the address
  // alone.
  std::uint32_t mask = 0xffffffff;
};

// An IPv4 address as such a number; 0: it is none.
std::uint32_t NumberOf(const std::string& address);
// True: `address` is of the network of `interface`.
bool IsOfNetwork(const InterfaceAddress& interface, std::uint32_t address);

// IPv4 addresses of all interfaces that are running (up, and with a carrier).
std::vector<InterfaceAddress> RunningInterfaces();

// 127.0.0.1 first, then the addresses of the named interfaces. Throws UsageError, with the option
// and what was expected, for a name that is not among `running`, or when loopback itself is not.
std::vector<InterfaceAddress> AllowedAddresses(const std::vector<std::string>& names,
                                               const std::vector<InterfaceAddress>& running);

bool IsLoopback(const std::string& address);  // 127.0.0.0/8

}  // namespace sinew::node::internal

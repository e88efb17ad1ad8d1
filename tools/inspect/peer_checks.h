// Problems between the participants of a domain: types, QoS, clocks, losses. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/topics/node/endpoint.h"
#include "components/topics/node/interfaces.h"
#include "tools/inspect/findings.h"

namespace sinew::inspect {

// A writer and a reader of one topic, of two participants, that do not match.
struct Mismatch {
  node::Endpoint writer, reader;
  std::vector<std::string> reasons;
};
// Endpoints of one participant do not count: nobody reads its own topics.
std::vector<Mismatch> Mismatches(const std::vector<node::Endpoint>& endpoints);

// `problems`: what the node has seen (builds with other types, QoS).
std::vector<Finding> CheckPeers(const std::vector<node::Endpoint>& endpoints,
                                const std::vector<std::string>& problems);

// Access to the robot's commands: what is open to a network without a key or DDS security.
struct Openness {
  std::vector<std::string> interfaces;  // of this process, beside loopback
  bool has_keys = false;                // so have all whom it hears
  // Addresses of this host in WireGuard tunnels: nobody without a key of the tunnel reaches them.
  std::vector<node::internal::InterfaceAddress> tunnels = {};
  std::string isolated = "";  // deployment in whose own network this process is
};
Finding CheckOpenness(const Openness& own, const std::vector<node::Endpoint>& endpoints);

// A message between hosts: when it was sent, by the sender's clock, and when it arrived here.
struct ClockSample {
  std::string host;
  std::int64_t sent_ns = 0, arrived_ns = 0;
  bool from_history = false;  // may have been sent long before it was asked for (TRANSIENT_LOCAL)
};
// Arrival - sending is the delay minus the offset of the sender's clock (positive: ahead); the
// delay is never negative. So a negative least difference is a clock that is ahead by at least so
// much, and a positive one a clock that is behind by at most so much. Up to a cycle of the rig in
// either direction is no finding. Samples from history are not compared.
std::vector<Finding> CheckClocks(const std::vector<ClockSample>& samples,
                                 const std::string& own_host);

// Messages that one host sends to another, and how many of them are lost.
struct Loss {
  std::string what;        // "joint_state of host 'robot'"
  std::uint64_t sent = 0;  // none: nothing was heard
  std::uint64_t lost = 0;
};
// Two in a hundred are no finding: a robot's tracking is no worse for them
// (tests/system/hosts_test.cc).
std::vector<Finding> CheckLosses(const std::vector<Loss>& losses);

}  // namespace sinew::inspect

// What is wrong between the participants of a domain: types, QoS, clocks. Pure.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "components/node/node.h"
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

// A message between hosts: when it was sent, by the sender's clock, and when it arrived here.
struct ClockSample {
  std::string host;
  std::int64_t sent_ns = 0, arrived_ns = 0;
};
// Arrival - sending is delay + offset of the clocks; the delay is never negative, so the least
// difference bounds the offset from above: a negative one is a clock that is ahead by at least so
// much. A difference above the limit is a clock that is behind, or a slow network.
std::vector<Finding> CheckClocks(const std::vector<ClockSample>& samples,
                                 const std::string& own_host);

}  // namespace sinew::inspect

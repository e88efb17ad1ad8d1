// Whether a writer and a reader of a topic match, and why not: type name, the request-offered rules
// of QoS and the partitions (OMG DDS 1.4, 2.2.3, table of QoS policies; XTypes 1.3, 7.6.3.1.2).
// Needs no DDS; pure.
#pragma once

#include <string>
#include <vector>

#include "components/topics/node/endpoint.h"

namespace sinew::node {

// "reliable, transient-local, exclusive, deadline 20 ms": reliability, and what is not DDS'
// default.
std::string DescribeQos(const EndpointQos& qos);

// One reason a line of what does not fit, with policy and both values. Empty: they match. The
// topics must be the same. Fast DDS 2.9 does not compare latency budget, destination order,
// presentation and data representation: between two of its participants these are no reason.
std::vector<std::string> WhyNotMatched(const Endpoint& writer, const Endpoint& reader);

}  // namespace sinew::node

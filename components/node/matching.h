// Whether a writer and a reader of a topic match, and why not: type name and the request-offered
// rules of QoS (OMG DDS 1.4, 2.2.3, table of QoS policies). Needs no DDS; pure.
#pragma once

#include <string>
#include <vector>

#include "components/node/node.h"

namespace sinew::node {

// "reliable, transient-local, exclusive, deadline 20 ms"
std::string DescribeQos(const EndpointQos& qos);

// One reason a line of what does not fit, with both values. Empty: they match. The topics must be
// the same.
std::vector<std::string> WhyNotMatched(const Endpoint& writer, const Endpoint& reader);

}  // namespace sinew::node

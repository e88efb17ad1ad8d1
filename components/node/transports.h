// The transports of a participant, restricted to the interfaces that its options name.
//
// Set-up only, any thread. Throws UsageError (interfaces.h, or a file of QoS profiles with a
// transport that cannot be restricted).
#pragma once

#include "components/node/dds_pch.h"
#include "components/node/options.h"

namespace sinew::node::internal {

// Replaces the built-in transports by the same ones bound to 127.0.0.1 and the named interfaces. A
// user's own transports (--qos) keep their interfaceWhiteList; UDPv4 without one gets ours. Warns
// once a process when something but loopback is open and the profile configures no DDS security.
void RestrictTransports(const Options& options, eprosima::fastdds::dds::DomainParticipantQos* qos);

}  // namespace sinew::node::internal

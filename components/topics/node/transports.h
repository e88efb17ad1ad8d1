// The transports of a participant, restricted to the interfaces that its options name.
//
// Set-up only, any thread. Throws UsageError (interfaces.h, or a file of QoS profiles with a
// transport that cannot be restricted).
#pragma once

#include "components/topics/node/dds_pch.h"
#include "components/topics/node/options.h"

namespace sinew::node::internal {

// Replaces the built-in transports: UDP bound to 127.0.0.1 and the named interfaces, and in
// lockstep shared memory beside it, which is faster there. Not in real time: a port in shared
// memory has locks that processes share, so that one that is killed, stopped or new can hold up the
// others (docs/decisions/0013-udp-in-real-time.md). A user's own transports (--qos) keep their
// interfaceWhiteList; UDPv4 without one gets ours. A recorder's socket takes more. Whatever a
// socket receives passes the key (datagram_key.h), where there is one, and a filter
// (datagram_filter.h). Warns once a process when something but loopback is open and there is
// neither a key nor DDS security.
void RestrictTransports(const Options& options, eprosima::fastdds::dds::DomainParticipantQos* qos);

// Shared memory is not filtered. Segments and ports are made for their user alone, by definitions
// of shm_open and fchmod in transports.cc; locks and semaphores, which hold no data and nobody else
// may write to, become so here, after the participant has made them.
void RestrictSharedMemory();

}  // namespace sinew::node::internal

// A transport of Fast DDS behind a DatagramFilter: what does not pass is never parsed.
//
// Threads: set-up by any; receive by the thread of each socket.
#pragma once

#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <memory>

namespace sinew::node::internal {

// A transport like `inner` that hands on what the filter passes. It logs the first datagram that
// is dropped, then every time their number has doubled, with the sender. secure: as DatagramFilter.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> Filtered(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> inner, bool secure);

// Datagrams that came to all participants of this process, and those of them that were dropped.
struct DatagramCounts {
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;
};
DatagramCounts ReceivedDatagrams();

}  // namespace sinew::node::internal

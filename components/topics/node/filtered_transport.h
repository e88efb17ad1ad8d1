// A transport of Fast DDS behind the key of a deployment and a DatagramFilter: what does not pass
// is never parsed.
//
// Threads: set-up by any; receive by the thread of each socket.
#pragma once

#include <fastdds/rtps/common/Locator.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include <memory>
#include <optional>
#include <vector>

#include "components/topics/node/datagram_filter.h"
#include "components/topics/node/datagram_key.h"
#include "components/topics/node/interfaces.h"

namespace sinew::node::internal {

// True for a receiving socket of discovery. RTPS 9.6.1.1: discovery has even ports (d0 = 0,
// d1 = 10, the gains are even), data odd ones (d2 = 1, d3 = 11), and UseFreshPorts keeps that.
inline bool IsDiscovery(const eprosima::fastrtps::rtps::Locator_t& receives) noexcept {
  return receives.port % 2 == 0;
}

// The senders whose datagrams are read.
struct Admission {
  Protection protection = Protection::kNone;
  std::optional<DatagramKey> key;      // none: everybody's
  std::vector<InterfaceAddress> open;  // with a key: networks whose hosts need no tag
  int copies = 1;                      // of a datagram to another host than this one's loopback
};

// A transport like `inner` that tags what is sent, where there is a key, sends its copies, and
// hands on what was admitted and passes the filter. RTPS takes a copy for what it is: readers drop
// a sequence number that they have, or an older one. It logs the first datagram that is dropped,
// then every time their number has doubled, with the sender and the reason.
//
// What comes to ports of discovery is handed on one after the other: Fast DDS 2.9 goes on with what
// it has just stored of a participant without its lock (PDPListener::onNewCacheChangeAdded), while
// the thread of another such port may replace it.
std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> Filtered(
    std::shared_ptr<eprosima::fastdds::rtps::TransportDescriptorInterface> inner,
    Admission admission);

// Datagrams that came to all participants of this process, and those of them that were dropped.
struct DatagramCounts {
  std::uint64_t received = 0;
  std::uint64_t dropped = 0;
};
DatagramCounts ReceivedDatagrams();

}  // namespace sinew::node::internal

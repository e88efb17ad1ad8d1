#include "components/node/transports.h"

#include <fastdds/rtps/attributes/PropertyPolicy.h>
#include <fastdds/rtps/transport/SocketTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "components/node/interfaces.h"

namespace sinew::node::internal {

namespace {

namespace transport = eprosima::fastdds::rtps;
namespace dds = eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::PropertyPolicyHelper;

constexpr char kPageOnHosts[] = "docs/how-to/several-hosts.md";

bool HasSecurity(const dds::DomainParticipantQos& qos) {
  return PropertyPolicyHelper::find_property(qos.properties(), "dds.sec.auth.plugin") != nullptr;
}

std::vector<std::string> AddressTexts(const std::vector<InterfaceAddress>& allowed) {
  std::vector<std::string> texts;
  texts.reserve(allowed.size());
  for (const InterfaceAddress& entry : allowed) texts.push_back(entry.address);
  return texts;
}

// A copy, because all participants of a process share the descriptors of a profile.
std::shared_ptr<transport::TransportDescriptorInterface> Restricted(
    const std::shared_ptr<transport::TransportDescriptorInterface>& descriptor,
    const std::vector<std::string>& addresses, const Options& options) {
  const auto socket = std::dynamic_pointer_cast<transport::SocketTransportDescriptor>(descriptor);
  if (!socket || !socket->interfaceWhiteList.empty()) return descriptor;
  const auto udp = std::dynamic_pointer_cast<transport::UDPv4TransportDescriptor>(descriptor);
  if (!udp) {
    throw UsageError(options.qos_path.string() +
                     ": a TCP or IPv6 transport is open to every network, expected an "
                     "interfaceWhiteList");
  }
  auto copy = std::make_shared<transport::UDPv4TransportDescriptor>(*udp);
  copy->interfaceWhiteList = addresses;
  return copy;
}

// Addresses but loopback that the transports use, with the interface where it is known.
std::string OpenAddresses(const dds::DomainParticipantQos& qos,
                          const std::vector<InterfaceAddress>& running) {
  std::vector<std::string> open;
  for (const auto& descriptor : qos.transport().user_transports) {
    const auto socket = std::dynamic_pointer_cast<transport::SocketTransportDescriptor>(descriptor);
    if (!socket) continue;
    for (const std::string& address : socket->interfaceWhiteList) {
      if (IsLoopback(address) || address == "::1") continue;
      const auto at = std::find_if(running.begin(), running.end(), [&address](const auto& entry) {
        return entry.address == address;
      });
      open.push_back(at == running.end() ? address : at->interface + " (" + address + ")");
    }
  }
  std::string text;
  for (const std::string& entry : open) text += (text.empty() ? "" : ", ") + entry;
  return text;
}

void WarnWhenOpen(const dds::DomainParticipantQos& qos,
                  const std::vector<InterfaceAddress>& running) {
  static std::once_flag once;
  const std::string open = OpenAddresses(qos, running);
  if (open.empty() || HasSecurity(qos)) return;
  std::call_once(once, [&open] {
    spdlog::warn(
        "open to the network on {} without DDS security: whoever reaches it can command the robot "
        "({})",
        open, kPageOnHosts);
  });
}

}  // namespace

void RestrictTransports(const Options& options, dds::DomainParticipantQos* qos) {
  const std::vector<InterfaceAddress> running = RunningInterfaces();
  const std::vector<std::string> addresses =
      AddressTexts(AllowedAddresses(options.interfaces, running));
  auto& used = qos->transport();
  for (auto& descriptor : used.user_transports) {
    descriptor = Restricted(descriptor, addresses, options);
  }
  if (used.use_builtin_transports) {
    used.use_builtin_transports = false;
    auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList = addresses;
    udp->sendBufferSize = used.send_socket_buffer_size;
    udp->receiveBufferSize = used.listen_socket_buffer_size;
    used.user_transports.push_back(udp);
    auto shared_memory = std::make_shared<transport::SharedMemTransportDescriptor>();
    shared_memory->max_message_size(udp->max_message_size());
    used.user_transports.push_back(shared_memory);
  }
  WarnWhenOpen(*qos, running);
}

}  // namespace sinew::node::internal

#include "components/topics/node/transports.h"

#include <dlfcn.h>
#include <fastdds/rtps/transport/SocketTransportDescriptor.h>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fcntl.h>
#include <spdlog/spdlog.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "components/topics/node/dds_security.h"
#include "components/topics/node/filtered_transport.h"
#include "components/topics/node/interfaces.h"

namespace sinew::node::internal {

namespace {

namespace transport = eprosima::fastdds::rtps;
namespace dds = eprosima::fastdds::dds;

constexpr char kPageOnHosts[] = "docs/how-to/several-hosts.md";

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

eprosima::fastrtps::rtps::Locator_t UdpLocator(const std::string& address) {
  eprosima::fastrtps::rtps::Locator_t locator;  // port 0: by the rule for all participants
  eprosima::fastrtps::rtps::IPLocator::createLocator(LOCATOR_KIND_UDPv4, address, 0, locator);
  return locator;
}

// Without shared memory, loopback is how peers on this host that name no interface reach one that
// does, and Fast DDS announces it only where it is alone. A user's own locators are left.
void AnnounceAll(const std::vector<std::string>& addresses, dds::DomainParticipantQos* qos) {
  auto& wire = qos->wire_protocol();
  auto& builtin = wire.builtin;
  if (addresses.size() < 2 || !wire.default_unicast_locator_list.empty() ||
      !builtin.metatrafficUnicastLocatorList.empty() ||
      !builtin.metatrafficMulticastLocatorList.empty()) {
    return;
  }
  for (const std::string& address : addresses) {
    wire.default_unicast_locator_list.push_back(UdpLocator(address));
    builtin.metatrafficUnicastLocatorList.push_back(UdpLocator(address));
  }
  constexpr char kDiscoveryGroup[] = "239.255.0.1";  // of the RTPS standard, 9.6.1.4
  builtin.metatrafficMulticastLocatorList.push_back(UdpLocator(kDiscoveryGroup));
}

void WarnWhenOpen(const dds::DomainParticipantQos& qos,
                  const std::vector<InterfaceAddress>& running) {
  static std::once_flag once;
  const std::string open = OpenAddresses(qos, running);
  if (open.empty() || ProtectionOf(qos) != Protection::kNone) return;
  std::call_once(once, [&open] {
    spdlog::warn(
        "open to the network on {} without a key or DDS security: whoever reaches it can command "
        "the robot (sinew security, {})",
        open, kPageOnHosts);
  });
}

Admission AdmissionOf(const Options& options, const std::vector<InterfaceAddress>& running,
                      Protection protection) {
  Admission out;
  out.protection = protection;
  out.copies = options.copies;
  if (!options.key_path.empty()) out.key = DatagramKey::Load(options.key_path);
  if (options.open_interfaces.empty()) return out;
  const std::string option = "--open " + options.open_interfaces.front();
  if (!out.key || protection == Protection::kNone) {
    throw UsageError(option +
                     ": expected a key (--key), and DDS security (--qos) for those who "
                     "join there without it");
  }
  for (const InterfaceAddress& allowed : AllowedAddresses(options.open_interfaces, running)) {
    const auto& names = options.open_interfaces;
    if (std::find(names.begin(), names.end(), allowed.interface) != names.end()) {
      out.open.push_back(allowed);
    }
  }
  return out;
}

// Bytes that wait in a recorder's socket while it is not scheduled: it reads every topic, 9 MB/s
// for 13 topics at 1 kHz (bench/logger), and what does not fit is lost. The system's default, 208
// KiB, is 23 ms of them, this is 0.4 s; the system grants at most net.core.rmem_max.
constexpr std::uint32_t kRecorderSocketBytes = 4u << 20;

bool IsRecorder(const Options& options) {
  return options.component == "logger" || options.component == "record";
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
    if (udp->receiveBufferSize == 0 && IsRecorder(options)) {
      udp->receiveBufferSize = kRecorderSocketBytes;
    }
    used.user_transports.push_back(udp);
    if (options.mode == TimeMode::kLockstep) {
      auto shared_memory = std::make_shared<transport::SharedMemTransportDescriptor>();
      shared_memory->max_message_size(udp->max_message_size());
      used.user_transports.push_back(shared_memory);
    } else {
      AnnounceAll(addresses, qos);
    }
  }
  Admission admission = AdmissionOf(options, running, ProtectionOf(*qos));
  if (std::all_of(addresses.begin(), addresses.end(), IsLoopback)) admission.copies = 1;
  if (!admission.key) WarnWhenOpen(*qos, running);
  for (auto& descriptor : used.user_transports) {
    if (std::dynamic_pointer_cast<transport::SocketTransportDescriptor>(descriptor)) {
      descriptor = Filtered(descriptor, admission);
    }
  }
}

void RestrictSharedMemory() {
  std::error_code ignored;  // one of a participant that has ended meanwhile
  for (const auto& entry : std::filesystem::directory_iterator("/dev/shm", ignored)) {
    // Or behind "sem."; refused for files of other users.
    const bool ours = entry.path().filename().string().rfind("fastrtps_", 4) != std::string::npos;
    if (ours) ::chmod(entry.path().c_str(), S_IRUSR | S_IWUSR);
  }
}

}  // namespace sinew::node::internal

// Shared memory of this process is its user's alone from the moment that it is made. Boost, inside
// of Fast DDS, makes it with 0644 and sets that again by fchmod(), whatever the umask is; a
// definition in the program comes before libc's.
namespace {

constexpr mode_t kOwnersAlone = S_IRUSR | S_IWUSR;
thread_local int made_here = -1;  // shared memory whose mode is still to be set

template <class Function>
Function OfLibc(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

// libc's names of the parameters are reserved.
// NOLINTBEGIN(readability-inconsistent-declaration-parameter-name)
int shm_open(const char* name, int flags, mode_t mode) {
  static const auto kOpen = OfLibc<int (*)(const char*, int, mode_t)>("shm_open");
  const int file = kOpen(name, flags, mode & kOwnersAlone);
  made_here = (flags & O_CREAT) != 0 ? file : -1;
  return file;
}

int fchmod(int file, mode_t mode) noexcept {
  if (file >= 0 && file == made_here) mode &= kOwnersAlone;
  made_here = -1;
  return static_cast<int>(::syscall(SYS_fchmod, file, mode));
}
// NOLINTEND(readability-inconsistent-declaration-parameter-name)

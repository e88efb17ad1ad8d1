#include "bridge/can/transport/bus_master.h"

#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "components/base/config/config.h"
#include "components/base/config/unix_socket.h"

namespace sinew::can {
namespace {

struct MasterName {
  sockaddr_un name{};
  socklen_t size = 0;
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&name); }
};

// A long path by its end: two that agree there exclude each other.
MasterName NameOf(const std::string& bus) {
  MasterName out;
  out.name.sun_family = AF_UNIX;
  constexpr std::size_t kMost = sizeof out.name.sun_path - 1;  // behind the 0 of abstract names
  std::string text = "sinew-bus-master:";
  text += bus.size() > kMost - text.size() ? bus.substr(bus.size() - (kMost - text.size())) : bus;
  std::memcpy(out.name.sun_path + 1, text.data(), text.size());
  out.size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + text.size());
  return out;
}

std::string Holder(const MasterName& address) {
  const config::Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const bool known = probe.get() >= 0 && ::connect(probe.get(), address.get(), address.size) == 0;
  const ucred peer = config::PeerOf(probe.get());
  return known ? "process " + std::to_string(peer.pid) + " of user " + std::to_string(peer.uid)
               : "another process";
}

}  // namespace

BusMaster::BusMaster(const std::string& bus) {
  const MasterName address = NameOf(bus);
  socket_ = config::Descriptor(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  // It listens, so that a second bridge learns whose it is; nobody is accepted.
  if (socket_.get() >= 0 && ::bind(socket_.get(), address.get(), address.size) == 0 &&
      ::listen(socket_.get(), 1) == 0) {
    return;
  }
  const int error = errno;
  socket_.Close();
  if (error == EADDRINUSE) {
    throw UsageError("bus '" + bus + "': " + Holder(address) +
                     " commands it already; end that one first");
  }
  throw UsageError("bus '" + bus + "': the right to command it: " + std::strerror(error));
}

}  // namespace sinew::can

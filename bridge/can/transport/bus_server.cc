#include "bridge/can/transport/bus_server.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <vector>

#include "bridge/can/transport/bus_protocol.h"
#include "bridge/can/transport/transport.h"
#include "bridge/can/transport/virtual_can.h"
#include "components/base/config/config.h"
#include "components/base/config/unix_socket.h"
#include "components/base/types/clock/clock.h"

namespace sinew::can {
namespace {

constexpr int kClientBuffer_bytes = 512 * 1024;
constexpr std::size_t kMostClients = 64;

bool SomebodyListens(const sockaddr_un& address) {
  const config::Descriptor probe(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
  return ::connect(probe.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
}

}  // namespace

std::string BusSocketPath(const std::string& bus) {
  if (bus.find('/') != std::string::npos) return bus;
  return config::PrivateSocket("sinew-can-" + bus + ".sock").string();
}

BusServer::BusServer(const std::string& bus, const BusConfig& config)
    : path_(BusSocketPath(bus)), folder_(config::FolderOf(path_)), model_(config) {
  const auto address_of_path = config::SocketAddress(path_);
  if (!address_of_path) throw UsageError("bus socket '" + path_ + "': the path is too long");
  const sockaddr_un address = *address_of_path;
  listener_ =
      config::Descriptor(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  const int listener = listener_.get();
  if (listener < 0)
    throw std::runtime_error(std::string("no Unix socket: ") + std::strerror(errno));
  const auto bind = [&] {
    return ::bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  };
  bool bound = bind();
  if (!bound && errno == EADDRINUSE) {
    struct stat info {};
    if (SomebodyListens(address)) {
      throw UsageError("bus socket '" + path_ + "': a bus of this name already runs");
    }
    if (::lstat(path_.c_str(), &info) == 0 && S_ISSOCK(info.st_mode) &&
        ::unlink(path_.c_str()) == 0) {
      bound = bind();
    } else {
      errno = EADDRINUSE;
    }
  }
  if (!bound || ::listen(listener, 16) != 0) {
    throw UsageError("bus socket '" + path_ + "': " + std::strerror(errno));
  }
}

BusServer::~BusServer() {
  for (const auto& [socket, client] : clients_) ::close(socket);
  listener_.Close();
  ::unlink(path_.c_str());
}

void BusServer::RunOnce(std::chrono::nanoseconds timeout) {
  std::int64_t wait_ns = std::max<std::int64_t>(timeout.count(), 0);
  if (const auto next = model_.NextEnd()) {
    wait_ns = std::clamp<std::int64_t>(*next - types::MonotonicNow_ns(), 0, wait_ns);
  }
  std::vector<pollfd> sockets;
  sockets.push_back({listener_.get(), POLLIN, 0});
  for (const auto& [socket, client] : clients_) sockets.push_back({socket, POLLIN, 0});
  const timespec wait{static_cast<time_t>(wait_ns / 1'000'000'000),
                      static_cast<long>(wait_ns % 1'000'000'000)};
  ::ppoll(sockets.data(), sockets.size(), &wait, nullptr);

  const std::int64_t now_ns = types::MonotonicNow_ns();
  model_.Advance(now_ns, [this](const Delivery& delivery) { Deliver(delivery); });
  if ((sockets.front().revents & POLLIN) != 0) Accept();
  for (std::size_t i = 1; i < sockets.size(); ++i) {
    if (sockets[i].revents != 0) Read(sockets[i].fd, now_ns);
  }
  SendErrorsAndHealth();
}

void BusServer::Accept() {
  const int socket = ::accept4(listener_.get(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
  if (socket < 0) return;
  if (clients_.size() >= kMostClients || !folder_.Admits(config::PeerOf(socket).uid)) {
    ::close(socket);
    return;
  }
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kClientBuffer_bytes, sizeof kClientBuffer_bytes);
  clients_[socket] = Client{model_.Attach(), NodeHealth::kActive};
  Packet welcome;
  welcome.kind = PacketKind::kWelcome;
  welcome.value = static_cast<std::uint32_t>(model_.config().bitrate_bit_s);
  SendTo(socket, &welcome, sizeof welcome);
}

void BusServer::Read(int socket, std::int64_t now_ns) {
  // At most a queue's worth at once, so that one client cannot keep the bus from the others.
  for (int i = 0; i < model_.config().queue_frames; ++i) {
    Packet packet;
    const ssize_t size = ::recv(socket, &packet, sizeof packet, MSG_DONTWAIT);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
    if (size <= 0) {
      Drop(socket);
      return;
    }
    if (size != sizeof packet || packet.magic != Packet::kMagic ||
        packet.kind != PacketKind::kFrame)
      continue;
    if (!model_.Offer(clients_.at(socket).node, FrameOf(packet), now_ns)) {
      packet.kind = PacketKind::kDropped;
      SendTo(socket, &packet, sizeof packet);
    }
  }
}

void BusServer::Drop(int socket) {
  const auto client = clients_.find(socket);
  if (client == clients_.end()) return;
  model_.Detach(client->second.node);
  clients_.erase(client);
  ::close(socket);
}

void BusServer::Deliver(const Delivery& delivery) {
  if (on_frame_) on_frame_(delivery);
  const Packet packet = FramePacket(delivery.frame, delivery.end_ns);
  for (const auto& [socket, client] : clients_) {
    const auto& senders = delivery.senders;
    if (std::find(senders.begin(), senders.end(), client.node) != senders.end()) continue;
    if (model_.health(client.node) == NodeHealth::kBusOff) continue;  // neither sends nor receives
    SendTo(socket, &packet, sizeof packet);
  }
}

void BusServer::SendErrorsAndHealth() {
  Packet packet;
  for (; sent_errors_ < model_.counters().error_frames; ++sent_errors_) {
    packet.kind = PacketKind::kError;
    for (const auto& [socket, client] : clients_) SendTo(socket, &packet, sizeof packet);
  }
  for (auto& [socket, client] : clients_) {
    const NodeHealth health = model_.health(client.node);
    if (health == client.health) continue;
    client.health = health;
    packet.kind = PacketKind::kHealth;
    packet.value = static_cast<std::uint32_t>(health);
    SendTo(socket, &packet, sizeof packet);
  }
}

void BusServer::SendTo(int socket, const void* data, std::size_t size) {
  if (::send(socket, data, size, MSG_DONTWAIT | MSG_NOSIGNAL) != static_cast<ssize_t>(size))
    ++lost_;
}

}  // namespace sinew::can

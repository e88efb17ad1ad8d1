#include "bridge/can/transport/virtual_can.h"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "bridge/can/bit_timing.h"
#include "bridge/can/bus_model.h"
#include "bridge/can/transport/bus_protocol.h"
#include "components/base/config/config.h"
#include "components/base/config/unix_socket.h"

namespace sinew::can {
namespace {

constexpr std::chrono::milliseconds kTryEvery(50);

}  // namespace

VirtualCan::VirtualCan(const VirtualCanOptions& options)
    : SocketTransport(kTryEvery),
      options_(options),
      path_(BusSocketPath(options.bus)),
      folder_(config::FolderOf(path_)) {
  const std::int64_t give_up_ns =
      types::MonotonicNow_ns() + std::chrono::nanoseconds(options.connect_timeout).count();
  while (!Connect() || !AwaitWelcome(give_up_ns)) {
    if (types::MonotonicNow_ns() >= give_up_ns) {
      const std::string who = stranger_ ? "user " + std::to_string(*stranger_) : "nobody";
      throw UsageError("bus '" + options.bus + "': " + who + " listens on " + path_ +
                       "; 'sinew-can-bus --bus " + options.bus + "' starts it");
    }
    const timespec wait{0, open_every_.count()};
    ::ppoll(nullptr, 0, &wait, nullptr);
  }
}

bool VirtualCan::Connect() noexcept {
  const auto address = config::SocketAddress(path_);
  if (!address) return false;
  socket_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (socket_ < 0) return false;
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&*address), sizeof *address) != 0) {
    Close();
    return false;
  }
  if (const uid_t user = config::PeerOf(socket_).uid; !folder_.Admits(user)) {
    stranger_ = user;
    Close();
    return false;
  }
  link_ = Link::kUp;
  return true;
}

// The server's first packet confirms that this node is on the bus: it receives everything from then
// on.
bool VirtualCan::AwaitWelcome(std::int64_t give_up_ns) noexcept {
  for (;;) {
    Packet packet;
    const ssize_t size = ::recv(socket_, &packet, sizeof packet, MSG_DONTWAIT);
    if (size == sizeof packet && packet.magic == Packet::kMagic &&
        packet.kind == PacketKind::kWelcome) {
      bitrate_bit_s_ = packet.value;
      return true;
    }
    const std::int64_t left_ns = give_up_ns - types::MonotonicNow_ns();
    if ((size < 0 && errno != EAGAIN && errno != EINTR) || size == 0 || left_ns <= 0) {
      Close();
      return false;
    }
    WaitForData(left_ns);
  }
}

// Whether a frame can be tried; else it is counted as dropped.
bool VirtualCan::Usable(const Frame& frame, SendStatus* why) noexcept {
  TryReopen();
  if (socket_ < 0 || link_ == Link::kBusOff) {
    *why = SendStatus::kDown;
  } else if (frame.fd) {  // a classic bus
    *why = SendStatus::kDropped;
  } else {
    return true;
  }
  ++counters_.dropped;
  return false;
}

SendStatus VirtualCan::OnNotSent(int error) noexcept {
  ++counters_.dropped;
  if (error == EAGAIN || error == ENOBUFS) return SendStatus::kDropped;
  Close();
  return SendStatus::kDown;
}

SendStatus VirtualCan::Send(const Frame& frame) noexcept {
  SendStatus why{};
  if (!Usable(frame, &why)) return why;
  const Packet packet = FramePacket(frame, 0);
  if (::send(socket_, &packet, sizeof packet, MSG_DONTWAIT | MSG_NOSIGNAL) != sizeof packet) {
    return OnNotSent(errno);
  }
  CountSent(frame);
  return SendStatus::kOk;
}

std::size_t VirtualCan::SendAll(std::span<const Frame> frames) noexcept {
  const std::size_t all = frames.size();
  std::array<Packet, kFramesAtOnce> packets;
  std::array<iovec, kFramesAtOnce> data;
  std::array<mmsghdr, kFramesAtOnce> headers;
  while (!frames.empty()) {
    SendStatus why{};
    if (!Usable(frames.front(), &why)) break;
    std::size_t count = 0;
    while (count < std::min(frames.size(), kFramesAtOnce) && !frames[count].fd) {
      packets[count] = FramePacket(frames[count], 0);
      data[count] = {&packets[count], sizeof(Packet)};
      headers[count] = {};
      headers[count].msg_hdr.msg_iov = &data[count];
      headers[count].msg_hdr.msg_iovlen = 1;
      ++count;
    }
    const int sent = ::sendmmsg(socket_, headers.data(), static_cast<unsigned>(count),
                                MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent <= 0) {
      (void)OnNotSent(errno);
      break;
    }
    for (const Frame& frame : frames.first(static_cast<std::size_t>(sent))) CountSent(frame);
    frames = frames.subspan(static_cast<std::size_t>(sent));
  }
  return all - frames.size();
}

std::size_t VirtualCan::TakeWaiting(std::span<Received> received) noexcept {
  TryReopen();
  std::array<Packet, kFramesAtOnce> packets;
  std::array<iovec, kFramesAtOnce> data;
  std::array<mmsghdr, kFramesAtOnce> headers;
  for (std::size_t i = 0; i < kFramesAtOnce; ++i) data[i] = {&packets[i], sizeof(Packet)};
  std::size_t taken = 0;
  while (socket_ >= 0 && taken < received.size()) {
    const std::size_t space = std::min(received.size() - taken, kFramesAtOnce);
    for (std::size_t i = 0; i < space; ++i) {
      headers[i] = {};
      headers[i].msg_hdr.msg_iov = &data[i];
      headers[i].msg_hdr.msg_iovlen = 1;
    }
    const int count =
        ::recvmmsg(socket_, headers.data(), static_cast<unsigned>(space), MSG_DONTWAIT, nullptr);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (count <= 0) {
      Close();
      break;
    }
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      if (headers[i].msg_len == 0) {  // the bus has gone
        Close();
        return taken;
      }
      if (headers[i].msg_len != sizeof(Packet) || packets[i].magic != Packet::kMagic) continue;
      if (Take(packets[i], &received[taken])) ++taken;
    }
  }
  return taken;
}

bool VirtualCan::Take(const Packet& packet, Received* received) noexcept {
  switch (packet.kind) {
    case PacketKind::kWelcome:
      bitrate_bit_s_ = packet.value;
      return false;
    case PacketKind::kDropped:
      --counters_.sent;
      ++counters_.dropped;
      return false;
    case PacketKind::kError:
      ++counters_.error_frames;
      return false;
    case PacketKind::kHealth:
      link_ = packet.value == static_cast<std::uint32_t>(NodeHealth::kBusOff)    ? Link::kBusOff
              : packet.value == static_cast<std::uint32_t>(NodeHealth::kPassive) ? Link::kPassive
                                                                                 : Link::kUp;
      return false;
    case PacketKind::kFrame:
      break;
  }
  if (packet.kind != PacketKind::kFrame) return false;
  const Frame frame = FrameOf(packet);
  if (!IsValid(frame)) return false;
  counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(frame));
  if (!Passes(options_.filters, frame)) return false;
  ++counters_.received;
  *received = {frame, packet.stamp_ns};
  return true;
}

}  // namespace sinew::can

// A node on a sinew-can-bus: the same interface as a real controller, for machines without CAN.
//
// The bus may start later than its nodes and may be restarted: the constructor waits for it a
// while, afterwards the link is down until it is back.
#pragma once

#include <optional>
#include <string>

#include "bridge/can/transport/transport.h"
#include "components/base/config/unix_socket.h"
#include "components/base/types/clock/clock.h"

namespace sinew::can {

struct Packet;

// A name without '/' means config::PrivateSocket. A bus counts only where SocketFolder::Admits its
// user.
std::string BusSocketPath(const std::string& bus);

struct VirtualCanOptions {
  std::string bus;                     // name or path of the socket
  std::vector<IdFilter> filters = {};  // empty: everything
  std::chrono::milliseconds connect_timeout{5000};
};

class VirtualCan : public Transport {
 public:
  // Throws UsageError when no bus of this name appears within the time.
  explicit VirtualCan(const VirtualCanOptions& options);
  ~VirtualCan() override;
  VirtualCan(const VirtualCan&) = delete;
  VirtualCan& operator=(const VirtualCan&) = delete;

  SendStatus Send(const Frame& frame) noexcept override;
  std::size_t SendAll(std::span<const Frame> frames) noexcept override;  // sendmmsg
  bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override;
  std::size_t TakeWaiting(std::span<Received> received) noexcept override;  // recvmmsg
  Link link() const noexcept override { return link_; }
  TransportCounters counters() const noexcept override { return counters_; }
  std::int64_t now_ns() const noexcept override { return types::MonotonicNow_ns(); }
  int descriptor() const noexcept override { return socket_; }
  const std::string& name() const noexcept override { return options_.bus; }

  double bitrate_bit_s() const { return bitrate_bit_s_; }  // as the bus says

 private:
  bool Connect() noexcept;
  bool AwaitWelcome(std::int64_t give_up_ns) noexcept;
  void Close() noexcept;
  void TryConnect() noexcept;
  bool Usable(const Frame& frame, SendStatus* why) noexcept;
  SendStatus OnNotSent(int error) noexcept;
  bool Take(const Packet& packet, Received* received) noexcept;  // false: no frame for us

  VirtualCanOptions options_;
  std::string path_;
  config::SocketFolder folder_;
  std::optional<uid_t> stranger_;  // another user, who listens there
  int socket_ = -1;
  Link link_ = Link::kDown;
  TransportCounters counters_;
  std::int64_t next_try_ns_ = 0;
  double bitrate_bit_s_ = 0.0;
};

}  // namespace sinew::can

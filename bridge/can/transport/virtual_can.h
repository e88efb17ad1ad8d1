// A node on a sinew-can-bus: the same interface as a real controller, for machines without CAN.
//
// The bus may start later than its nodes and may be restarted: the constructor waits for it a
// while, afterwards the link is down until it is back.
#pragma once

#include <optional>
#include <string>

#include "bridge/can/transport/transport.h"
#include "components/base/config/unix_socket.h"

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

class VirtualCan : public SocketTransport {
 public:
  // Throws UsageError when no bus of this name appears within the time.
  explicit VirtualCan(const VirtualCanOptions& options);

  SendStatus Send(const Frame& frame) noexcept override;
  std::size_t SendAll(std::span<const Frame> frames) noexcept override;     // sendmmsg
  std::size_t TakeWaiting(std::span<Received> received) noexcept override;  // recvmmsg
  const std::string& name() const noexcept override { return options_.bus; }

  double bitrate_bit_s() const { return bitrate_bit_s_; }  // as the bus says

 private:
  bool Connect() noexcept;
  bool AwaitWelcome(std::int64_t give_up_ns) noexcept;
  void Reopen() noexcept override { (void)Connect(); }
  bool Usable(const Frame& frame, SendStatus* why) noexcept;
  SendStatus OnNotSent(int error) noexcept;
  bool Take(const Packet& packet, Received* received) noexcept;  // false: no frame for us

  VirtualCanOptions options_;
  std::string path_;
  config::SocketFolder folder_;
  std::optional<uid_t> stranger_;  // another user, who listens there
  double bitrate_bit_s_ = 0.0;
};

}  // namespace sinew::can

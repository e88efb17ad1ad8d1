// SocketCAN (Linux, CAN_RAW): a real controller, vcan, slcan.
//
// Kernel filters for exactly the identifiers asked for, reports of the controller as error frames,
// receive stamps by SO_TIMESTAMPING (hardware's where the driver has them) turned into
// CLOCK_MONOTONIC, writes that never block: a full queue (ENOBUFS, EAGAIN) drops the frame and
// counts it. On an interface set up for CAN FD (its MTU says so) FD frames are sent and received,
// too; elsewhere an FD frame is dropped and counted. Bus-off and restart come from error frames; an
// interface that goes down and comes up again is used again, one that vanishes and returns is
// opened again.
#pragma once

#include "bridge/can/transport/transport.h"
#include "components/base/types/clock/clock.h"

namespace sinew::can {

struct SocketCanOptions {
  std::string interface;
  std::vector<IdFilter> filters = {};  // empty: everything
  int send_buffer_bytes =
      0;  // 0: the system's. Small ones bound how many frames can wait in the kernel
};

class SocketCan : public Transport {
 public:
  // Throws UsageError in one line when the kernel has no CAN, the interface is absent, no CAN
  // interface, or down.
  explicit SocketCan(const SocketCanOptions& options);
  ~SocketCan() override;
  SocketCan(const SocketCan&) = delete;
  SocketCan& operator=(const SocketCan&) = delete;

  SendStatus Send(const Frame& frame) noexcept override;
  std::size_t SendAll(std::span<const Frame> frames) noexcept override;  // sendmmsg
  bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override;
  std::size_t TakeWaiting(std::span<Received> received) noexcept override;  // recvmmsg
  Link link() const noexcept override { return link_; }
  TransportCounters counters() const noexcept override { return counters_; }
  std::int64_t now_ns() const noexcept override { return types::MonotonicNow_ns(); }
  int descriptor() const noexcept override { return socket_; }
  const std::string& name() const noexcept override { return options_.interface; }

 private:
  // Empty: opened. Else what is wrong and what helps.
  std::string Open() noexcept;
  void Close() noexcept;
  void OnErrno(int error) noexcept;
  SendStatus OnSent(const Frame& frame) noexcept;
  SendStatus OnNotSent(int error) noexcept;
  void OnErrorFrame(const Frame& frame) noexcept;
  void TryReopen() noexcept;

  SocketCanOptions options_;
  int socket_ = -1;
  bool fd_ = false;  // the interface carries FD frames
  Link link_ = Link::kDown;
  TransportCounters counters_;
  std::int64_t next_reopen_ns_ = 0;
};

}  // namespace sinew::can

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

namespace sinew::can {

struct SocketCanOptions {
  std::string interface;
  std::vector<IdFilter> filters = {};  // empty: everything
  int send_buffer_bytes =
      0;  // 0: the system's. Small ones bound how many frames can wait in the kernel
};

class SocketCan : public SocketTransport {
 public:
  // Throws UsageError in one line when the kernel has no CAN, the interface is absent, no CAN
  // interface, or down.
  explicit SocketCan(const SocketCanOptions& options);

  SendStatus Send(const Frame& frame) noexcept override;
  std::size_t SendAll(std::span<const Frame> frames) noexcept override;     // sendmmsg
  std::size_t TakeWaiting(std::span<Received> received) noexcept override;  // recvmmsg
  const std::string& name() const noexcept override { return options_.interface; }

 private:
  // Empty: opened. Else what is wrong and what helps.
  std::string Open() noexcept;
  void Reopen() noexcept override { (void)Open(); }
  void OnErrno(int error) noexcept;
  SendStatus OnSent(const Frame& frame) noexcept;
  SendStatus OnNotSent(int error) noexcept;
  void OnErrorFrame(const Frame& frame) noexcept;

  SocketCanOptions options_;
  bool fd_ = false;  // the interface carries FD frames
};

}  // namespace sinew::can

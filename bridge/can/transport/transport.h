// A place on a CAN bus, whatever carries it: SocketCAN, a bus between processes, one in memory, a
// log.
//
// Nothing here waits except Receive with a time-out. Send never queues what cannot go now: a
// setpoint that is late is worth nothing, the next one is under way. One thread per transport.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bridge/can/frame.h"
#include "components/base/types/clock/clock.h"

namespace sinew::can {

enum class [[nodiscard]] SendStatus{
    kOk,       // on its way
    kDropped,  // no space: counted, forgotten
    kDown,     // the bus is down, bus-off or gone: counted, forgotten
};

enum class Link { kUp, kPassive, kBusOff, kDown };

const char* LinkName(Link link);

struct Received {
  Frame frame;
  std::int64_t stamp_ns = 0;  // when it was on the bus, on the clock of now_ns()
};

struct TransportCounters {
  std::uint64_t sent = 0;
  std::uint64_t received = 0;  // data and remote frames
  std::uint64_t dropped = 0;   // own frames that never went
  std::uint64_t lost = 0;  // others' frames that were not read in time, where the system reports it
  std::uint64_t error_frames = 0;  // reports of the controller, collisions
  std::uint64_t wire_bits = 0;     // of all frames sent and seen here, with their stuff bits
};

inline constexpr std::size_t kFramesAtOnce = 32;  // most of a system call

// Frames whose identifier agrees with `id` in the bits of `mask`; standard or extended ones.
struct IdFilter {
  std::uint32_t id = 0;
  std::uint32_t mask = 0;
  bool extended = false;
};
bool Passes(std::span<const IdFilter> filters, const Frame& frame);

class Transport {
 public:
  virtual ~Transport() = default;

  virtual SendStatus Send(const Frame& frame) noexcept = 0;
  // In order, with few system calls where the transport can, until one is not sent, which is
  // counted and forgotten. Returns how many stand before it: all, where none was lost.
  virtual std::size_t SendAll(std::span<const Frame> frames) noexcept;
  // The oldest waiting frame; waits at most `timeout` for one. Error frames are handed on, too.
  virtual bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept = 0;
  // The oldest that wait, as many as there is space for, with few system calls where the transport
  // can. Returns how many; 0: none waits. Never waits.
  virtual std::size_t TakeWaiting(std::span<Received> received) noexcept;

  virtual Link link() const noexcept = 0;
  virtual TransportCounters counters() const noexcept = 0;
  // Clock of the stamps: CLOCK_MONOTONIC, or simulated time.
  virtual std::int64_t now_ns() const noexcept = 0;
  // For poll(); -1 when there is nothing to poll.
  virtual int descriptor() const noexcept { return -1; }
  virtual const std::string& name() const noexcept = 0;
};

// A place on a bus at the other end of a socket, which is opened again when it was lost.
class SocketTransport : public Transport {
 public:
  SocketTransport(const SocketTransport&) = delete;
  SocketTransport& operator=(const SocketTransport&) = delete;
  ~SocketTransport() override { Close(); }

  bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override;
  Link link() const noexcept override { return link_; }
  TransportCounters counters() const noexcept override { return counters_; }
  std::int64_t now_ns() const noexcept override { return types::MonotonicNow_ns(); }
  int descriptor() const noexcept override { return socket_; }

 protected:
  explicit SocketTransport(std::chrono::nanoseconds open_every) : open_every_(open_every) {}

  virtual void Reopen() noexcept = 0;  // sets socket_ and link_, or leaves them
  void TryReopen() noexcept;           // without a socket, and not more often than open_every
  void Close() noexcept;
  void CountSent(const Frame& frame) noexcept;
  void WaitForData(std::int64_t limit_ns) noexcept;

  const std::chrono::nanoseconds open_every_;
  int socket_ = -1;
  Link link_ = Link::kDown;
  TransportCounters counters_;

 private:
  std::int64_t next_try_ns_ = 0;
};

// Waits until one of the transports has something to read, or the time is over. Transports without
// a descriptor are not waited for.
void WaitForAny(std::span<Transport* const> transports, std::chrono::nanoseconds timeout) noexcept;

}  // namespace sinew::can

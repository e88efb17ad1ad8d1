#include "bridge/can/transport/transport.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>

#include "bridge/can/bit_timing.h"

namespace sinew::can {

const char* LinkName(Link link) {
  switch (link) {
    case Link::kUp:
      return "up";
    case Link::kPassive:
      return "error passive";
    case Link::kBusOff:
      return "bus-off";
    case Link::kDown:
      return "down";
  }
  return "unknown";
}

bool Passes(std::span<const IdFilter> filters, const Frame& frame) {
  return filters.empty() ||
         std::any_of(filters.begin(), filters.end(), [&frame](const IdFilter& f) {
           return f.extended == frame.extended && ((frame.id ^ f.id) & f.mask) == 0;
         });
}

void WaitForAny(std::span<Transport* const> transports, std::chrono::nanoseconds timeout) noexcept {
  std::array<pollfd, 16> descriptors{};
  nfds_t count = 0;
  for (const Transport* transport : transports) {
    if (transport->descriptor() >= 0 && count < descriptors.size()) {
      descriptors[count++] = {transport->descriptor(), POLLIN, 0};
    }
  }
  const auto nanoseconds = std::max<std::int64_t>(timeout.count(), 0);
  const timespec wait{static_cast<time_t>(nanoseconds / 1'000'000'000),
                      static_cast<long>(nanoseconds % 1'000'000'000)};
  ::ppoll(descriptors.data(), count, &wait, nullptr);
}

std::size_t Transport::SendAll(std::span<const Frame> frames) noexcept {
  const auto lost = std::find_if(frames.begin(), frames.end(), [this](const Frame& frame) {
    return Send(frame) != SendStatus::kOk;
  });
  return static_cast<std::size_t>(lost - frames.begin());
}

std::size_t Transport::TakeWaiting(std::span<Received> received) noexcept {
  std::size_t count = 0;
  while (count < received.size() && Receive(std::chrono::nanoseconds(0), &received[count])) ++count;
  return count;
}

void SocketTransport::TryReopen() noexcept {
  const std::int64_t now = now_ns();
  if (socket_ >= 0 || now < next_try_ns_) return;
  next_try_ns_ = now + open_every_.count();
  Reopen();
}

void SocketTransport::Close() noexcept {
  if (socket_ >= 0) ::close(socket_);
  socket_ = -1;
  link_ = Link::kDown;
}

void SocketTransport::CountSent(const Frame& frame) noexcept {
  ++counters_.sent;
  counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(frame));
}

void SocketTransport::WaitForData(std::int64_t limit_ns) noexcept {
  Transport* const self = this;
  WaitForAny({&self, 1}, std::chrono::nanoseconds(limit_ns));
}

bool SocketTransport::Receive(std::chrono::nanoseconds timeout, Received* received) noexcept {
  const std::int64_t give_up_ns = now_ns() + std::max<std::int64_t>(timeout.count(), 0);
  for (;;) {
    if (TakeWaiting({received, 1}) > 0) return true;
    const std::int64_t left_ns = give_up_ns - now_ns();
    if (left_ns <= 0) return false;
    // Without a socket: looks for the bus again now and then.
    WaitForData(socket_ < 0 ? std::min<std::int64_t>(left_ns, open_every_.count()) : left_ns);
  }
}

}  // namespace sinew::can

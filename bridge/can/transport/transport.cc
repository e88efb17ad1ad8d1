#include "bridge/can/transport/transport.h"

#include <poll.h>

#include <algorithm>
#include <array>
#include <ctime>

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

}  // namespace sinew::can

// A raw CAN socket, to inject what our transport does not send: malformed frames, error frames.
#pragma once

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <initializer_list>
#include <stdexcept>
#include <string>

namespace sinew::can {

// The interface that run_on_kernel.sh made.
inline std::string Interface() {
  const char* name = std::getenv("SINEW_CAN_INTERFACE");
  return name == nullptr ? "vcan0" : name;
}

class RawSocket {
 public:
  RawSocket() {
    socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
    ifreq request{};
    std::strncpy(request.ifr_name, Interface().c_str(), IFNAMSIZ - 1);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    const bool found = ::ioctl(socket_, SIOCGIFINDEX, &request) == 0;
    address.can_ifindex = request.ifr_ifindex;
    // It only sends: nothing is to pile up here.
    if (!found || ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, nullptr, 0) != 0 ||
        ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
      ::close(socket_);
      throw std::runtime_error("no raw socket on " + Interface());
    }
  }
  ~RawSocket() { ::close(socket_); }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;

  // False: the kernel did not take it.
  bool Send(const can_frame& frame) const {
    return ::write(socket_, &frame, sizeof frame) == static_cast<ssize_t>(sizeof frame);
  }
  // A report of the controller. Its bytes are those of linux/can/error.h.
  bool SendError(canid_t kind, std::initializer_list<int> bytes = {}) const {
    can_frame frame{};
    frame.can_id = CAN_ERR_FLAG | kind;
    frame.can_dlc = CAN_MAX_DLEN;
    std::transform(bytes.begin(), bytes.end(), frame.data,
                   [](int byte) { return static_cast<__u8>(byte); });
    return Send(frame);
  }

 private:
  int socket_ = -1;
};

}  // namespace sinew::can

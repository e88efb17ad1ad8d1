#include "bridge/can/transport/socketcan.h"

#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/net_tstamp.h>
#include <net/if.h>
#include <net/if_arp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>

#include "bridge/can/bit_timing.h"
#include "components/base/config/config.h"

namespace sinew::can {
namespace {

constexpr std::chrono::milliseconds kReopenEvery(100);
// Lost arbitration is daily life; everything else is worth knowing.
constexpr can_err_mask_t kErrors = CAN_ERR_MASK & ~static_cast<unsigned>(CAN_ERR_LOSTARB);

// Classic frames are the front of a canfd_frame (linux/can.h).
canfd_frame ToKernel(const Frame& frame) {
  canfd_frame result{};
  result.can_id = frame.id;
  if (frame.extended) result.can_id |= CAN_EFF_FLAG;
  if (frame.remote) result.can_id |= CAN_RTR_FLAG;
  if (frame.bit_rate_switch) result.flags |= CANFD_BRS;
  result.len = std::min<std::uint8_t>(frame.length, frame.fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  if (!frame.remote) std::memcpy(result.data, frame.data.data(), result.len);
  return result;
}

Frame FromKernel(const canfd_frame& frame, bool fd) {
  Frame result;
  result.error = (frame.can_id & CAN_ERR_FLAG) != 0;
  result.extended = !result.error && (frame.can_id & CAN_EFF_FLAG) != 0;
  result.remote = !result.error && (frame.can_id & CAN_RTR_FLAG) != 0;
  result.id = frame.can_id & (result.extended || result.error ? CAN_EFF_MASK : CAN_SFF_MASK);
  result.fd = fd;
  result.bit_rate_switch = fd && (frame.flags & CANFD_BRS) != 0;
  result.length = std::min<std::uint8_t>(frame.len, fd ? CANFD_MAX_DLEN : CAN_MAX_DLEN);
  if (!result.remote) std::memcpy(result.data.data(), frame.data, result.length);
  return result;
}

std::int64_t ToNs(const timespec& time) {
  return static_cast<std::int64_t>(time.tv_sec) * 1'000'000'000 + time.tv_nsec;
}

// The kernel's running count of frames it had no space for.
void ReadLost(msghdr& message, std::uint64_t* lost) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_RXQ_OVFL) continue;
    std::uint32_t count = 0;
    std::memcpy(&count, CMSG_DATA(c), sizeof count);
    *lost = count;
  }
}

struct Clocks {
  std::int64_t monotonic_ns = 0;
  std::int64_t epoch_ns = 0;
};

Clocks ReadClocks() {
  const std::int64_t epoch_ns = types::EpochNow_ns();
  return {types::MonotonicNow_ns(), epoch_ns};
}

// The kernel stamps in epoch time; ours is monotonic. What counts is how long ago it was.
std::int64_t MonotonicStamp(msghdr& message, const Clocks& now) {
  for (cmsghdr* c = CMSG_FIRSTHDR(&message); c != nullptr; c = CMSG_NXTHDR(&message, c)) {
    if (c->cmsg_level != SOL_SOCKET || c->cmsg_type != SO_TIMESTAMPING) continue;
    timespec stamps[3];  // software, (unused), raw hardware
    std::memcpy(stamps, CMSG_DATA(c), sizeof stamps);
    if (stamps[0].tv_sec == 0 && stamps[0].tv_nsec == 0) break;
    const std::int64_t age_ns = now.epoch_ns - ToNs(stamps[0]);
    // A clock that was set in between must not make a frame older than a second, or younger than
    // now.
    return now.monotonic_ns - std::clamp<std::int64_t>(age_ns, 0, 1'000'000'000);
  }
  return now.monotonic_ns;
}

// Space for what the kernel writes of one or several frames.
template <std::size_t kCount>
class Messages {
 public:
  Messages() {
    for (std::size_t i = 0; i < kCount; ++i) {
      data_[i] = {&frames[i], sizeof frames[i]};
      headers[i].msg_hdr = {};
      headers[i].msg_hdr.msg_iov = &data_[i];
      headers[i].msg_hdr.msg_iovlen = 1;
    }
  }
  void WithControl() {
    for (std::size_t i = 0; i < kCount; ++i) {
      headers[i].msg_hdr.msg_control = control_[i].data();
      headers[i].msg_hdr.msg_controllen = control_[i].size();
    }
  }
  void SetSize(std::size_t i, std::size_t bytes) { data_[i].iov_len = bytes; }

  std::array<canfd_frame, kCount> frames;
  std::array<mmsghdr, kCount> headers;

 private:
  struct alignas(cmsghdr) Control : std::array<char, 128> {};
  std::array<iovec, kCount> data_;
  std::array<Control, kCount> control_;
};

}  // namespace

SocketCan::SocketCan(const SocketCanOptions& options)
    : SocketTransport(kReopenEvery), options_(options) {
  const std::string problem = Open();
  if (!problem.empty()) throw UsageError(problem);
}

std::string SocketCan::Open() noexcept {
  const std::string& interface = options_.interface;
  if (interface.empty() || interface.size() >= IFNAMSIZ) {
    return "interface '" + interface + "': expected a name of 1 to 15 characters, such as can0";
  }
  socket_ = ::socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (socket_ < 0) {
    const int error = errno;
    if (error == EAFNOSUPPORT || error == EPROTONOSUPPORT) {
      return interface +
             ": this kernel has no SocketCAN; try 'modprobe can_raw', or transport: virtual";
    }
    return interface + ": no CAN socket: " + std::strerror(error);
  }
  const auto fail = [this](std::string message) {
    Close();
    return message;
  };
  ifreq request{};
  std::memcpy(request.ifr_name, interface.c_str(), interface.size() + 1);
  if (::ioctl(socket_, SIOCGIFINDEX, &request) != 0) {
    return fail(interface + ": no such interface; 'ip -brief link' lists those there are");
  }
  const int index = request.ifr_ifindex;
  if (::ioctl(socket_, SIOCGIFHWADDR, &request) == 0 &&
      request.ifr_hwaddr.sa_family != ARPHRD_CAN) {
    return fail(interface + ": not a CAN interface");
  }
  if (::ioctl(socket_, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0) {
    return fail(interface + ": the interface is down; 'ip link set " + interface +
                " up type can bitrate 1000000 restart-ms 100' starts it");
  }
  std::vector<can_filter> filters;
  for (const IdFilter& f : options_.filters) {
    // Exactly this kind of identifier: the flag is part of the comparison. Remote frames pass as
    // well.
    filters.push_back({f.id | (f.extended ? CAN_EFF_FLAG : 0U), f.mask | CAN_EFF_FLAG});
  }
  if (!filters.empty() &&
      ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FILTER, filters.data(),
                   static_cast<socklen_t>(filters.size() * sizeof(can_filter))) != 0) {
    return fail(interface + ": filters refused: " + std::strerror(errno));
  }
  const can_err_mask_t errors = kErrors;
  if (::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof errors) != 0) {
    return fail(interface + ": error frames refused: " + std::strerror(errno));
  }
  const int stamps = SOF_TIMESTAMPING_RX_SOFTWARE | SOF_TIMESTAMPING_SOFTWARE;
  if (::setsockopt(socket_, SOL_SOCKET, SO_TIMESTAMPING, &stamps, sizeof stamps) != 0) {
    return fail(interface + ": time stamps refused: " + std::strerror(errno));
  }
  const int count_lost = 1;
  if (::setsockopt(socket_, SOL_SOCKET, SO_RXQ_OVFL, &count_lost, sizeof count_lost) != 0) {
    return fail(interface + ": count of lost frames refused: " + std::strerror(errno));
  }
  if (options_.send_buffer_bytes > 0 &&
      ::setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &options_.send_buffer_bytes,
                   sizeof options_.send_buffer_bytes) != 0) {
    return fail(interface + ": send buffer refused: " + std::strerror(errno));
  }
  // FD frames where the interface carries them; a kernel that refuses leaves us classic frames.
  const int on = 1;
  fd_ = ::ioctl(socket_, SIOCGIFMTU, &request) == 0 && request.ifr_mtu == CANFD_MTU &&
        ::setsockopt(socket_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on) == 0;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    return fail(interface + ": " + std::strerror(errno));
  }
  link_ = Link::kUp;
  return {};
}

void SocketCan::OnErrno(int error) noexcept {
  switch (error) {
    case ENETDOWN:
      link_ = Link::kDown;  // the socket stays bound and works again when the interface is up
      break;
    case ENODEV:
    case ENXIO:
    case EBADF:
      Close();  // the interface is gone: a new one of that name has another index
      break;
    default:
      break;
  }
}

SendStatus SocketCan::OnSent(const Frame& frame) noexcept {
  if (link_ == Link::kDown) link_ = Link::kUp;
  CountSent(frame);
  return SendStatus::kOk;
}

SendStatus SocketCan::OnNotSent(int error) noexcept {
  ++counters_.dropped;
  OnErrno(error);
  return error == ENOBUFS || error == EAGAIN ? SendStatus::kDropped : SendStatus::kDown;
}

SendStatus SocketCan::Send(const Frame& frame) noexcept {
  TryReopen();
  if (socket_ < 0) {
    ++counters_.dropped;
    return SendStatus::kDown;
  }
  if (frame.fd && !fd_) {
    ++counters_.dropped;
    return SendStatus::kDropped;
  }
  const canfd_frame out = ToKernel(frame);
  const ssize_t size = frame.fd ? CANFD_MTU : CAN_MTU;
  const ssize_t sent =
      ::send(socket_, &out, static_cast<std::size_t>(size), MSG_DONTWAIT | MSG_NOSIGNAL);
  return sent == size ? OnSent(frame) : OnNotSent(errno);
}

std::size_t SocketCan::SendAll(std::span<const Frame> frames) noexcept {
  Messages<kFramesAtOnce> out;
  const std::size_t all = frames.size();
  while (!frames.empty()) {
    TryReopen();
    std::size_t count = 0;
    while (socket_ >= 0 && count < std::min(frames.size(), kFramesAtOnce) &&
           (fd_ || !frames[count].fd)) {
      out.frames[count] = ToKernel(frames[count]);
      out.SetSize(count, frames[count].fd ? CANFD_MTU : CAN_MTU);
      ++count;
    }
    const int sent = count == 0
                         ? 0
                         : ::sendmmsg(socket_, out.headers.data(), static_cast<unsigned>(count),
                                      MSG_DONTWAIT | MSG_NOSIGNAL);
    if (sent > 0) {
      for (int i = 0; i < sent; ++i) (void)OnSent(frames[static_cast<std::size_t>(i)]);
      frames = frames.subspan(static_cast<std::size_t>(sent));
      continue;
    }
    // The first one has no space, no bus, or cannot be carried.
    if (count == 0) {
      ++counters_.dropped;
    } else {
      (void)OnNotSent(errno);
    }
    break;
  }
  return all - frames.size();
}

std::size_t SocketCan::TakeWaiting(std::span<Received> received) noexcept {
  TryReopen();
  Messages<kFramesAtOnce> in;
  std::size_t taken = 0;
  while (socket_ >= 0 && taken < received.size()) {
    in.WithControl();
    const std::size_t space = std::min(received.size() - taken, kFramesAtOnce);
    const int count =
        ::recvmmsg(socket_, in.headers.data(), static_cast<unsigned>(space), MSG_DONTWAIT, nullptr);
    if (count < 0 && errno != EAGAIN && errno != EINTR) OnErrno(errno);
    if (count <= 0) break;
    const Clocks now = ReadClocks();
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const unsigned size = in.headers[i].msg_len;
      if (size != CAN_MTU && size != CANFD_MTU) continue;
      Received& next = received[taken++];
      next.frame = FromKernel(in.frames[i], size == CANFD_MTU);
      next.stamp_ns = MonotonicStamp(in.headers[i].msg_hdr, now);
      ReadLost(in.headers[i].msg_hdr, &counters_.lost);
      if (next.frame.error) {
        OnErrorFrame(next.frame);
      } else {
        if (link_ == Link::kDown || link_ == Link::kBusOff) link_ = Link::kUp;
        ++counters_.received;
        counters_.wire_bits += static_cast<std::uint64_t>(FrameBits(next.frame));
      }
    }
    if (static_cast<std::size_t>(count) < space) break;  // none was left
  }
  return taken;
}

void SocketCan::OnErrorFrame(const Frame& frame) noexcept {
  ++counters_.error_frames;
  if ((frame.id & CAN_ERR_BUSOFF) != 0) {
    link_ = Link::kBusOff;
  } else if ((frame.id & CAN_ERR_RESTARTED) != 0) {
    link_ = Link::kUp;
  } else if ((frame.id & CAN_ERR_CRTL) != 0) {
    if ((frame.data[1] & (CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE)) != 0) {
      link_ = Link::kPassive;
    } else if ((frame.data[1] & CAN_ERR_CRTL_ACTIVE) != 0) {
      link_ = Link::kUp;
    }
  }
}

}  // namespace sinew::can

#include "tests/support/cable.h"

#include <fcntl.h>
#include <linux/if_tun.h>
#include <net/if.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <sys/eventfd.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <utility>

namespace sinew::testing {

namespace {

using config::Descriptor;

constexpr char kInterface[] = "wire0";
constexpr std::size_t kLargestFrame = 65'536;
constexpr std::chrono::milliseconds kRepeatedAfter(1);

// kind: "net", "uts".
Descriptor NamespaceOf(const std::string& process, const std::string& kind) {
  Descriptor out(::open(("/proc/" + process + "/ns/" + kind).c_str(), O_RDONLY | O_CLOEXEC));
  if (out.get() < 0) throw std::runtime_error("namespaces of process " + process);
  return out;
}

// A device of the network in which the calling thread is.
Descriptor OpenDevice() {
  Descriptor device(::open("/dev/net/tun", O_RDWR | O_NONBLOCK | O_CLOEXEC));
  ifreq request{};
  request.ifr_flags = IFF_TAP | IFF_NO_PI;
  std::strcpy(request.ifr_name, kInterface);
  if (device.get() < 0 || ::ioctl(device.get(), TUNSETIFF, &request) != 0) {
    throw std::runtime_error(std::string("/dev/net/tun: ") + std::strerror(errno));
  }
  return device;
}

}  // namespace

OnHost::OnHost(pid_t host)
    : network_(NamespaceOf("thread-self", "net")), name_(NamespaceOf("thread-self", "uts")) {
  const std::string process = std::to_string(host);
  if (::setns(NamespaceOf(process, "net").get(), CLONE_NEWNET) != 0 ||
      ::setns(NamespaceOf(process, "uts").get(), CLONE_NEWUTS) != 0) {
    throw std::runtime_error(std::string("setns: ") + std::strerror(errno));
  }
}

OnHost::~OnHost() {
  (void)::setns(network_.get(), CLONE_NEWNET);
  (void)::setns(name_.get(), CLONE_NEWUTS);
}

Cable::Cable(const std::vector<pid_t>& hosts, std::uint32_t seed)
    : wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)), random_(seed) {
  try {
    for (const pid_t host : hosts) {
      const OnHost there(host);
      ports_.push_back({OpenDevice()});
    }
  } catch (const std::exception& error) {
    why_not_ = error.what();
    return;
  }
  thread_ = std::thread([this] { Forward(); });
}

Cable::~Cable() {
  if (!thread_.joinable()) return;
  const std::uint64_t one = 1;
  (void)!::write(wake_.get(), &one, sizeof one);
  thread_.join();
}

void Cable::Set(const CableQuality& quality) {
  const std::lock_guard lock(mutex_);
  quality_ = quality;
}

void Cable::Cut(std::size_t host, std::chrono::milliseconds duration) {
  const std::lock_guard lock(mutex_);
  ports_[host].cut_until = Clock::now() + duration;
}

bool Cable::Draw(double share) {
  return share > 0.0 && std::uniform_real_distribution<double>(0.0, 1.0)(random_) < share;
}

// A frame that a device cannot take is lost, as on a cable that is not plugged in.
void Cable::Send(std::size_t host, const std::string& frame) {
  if (::write(ports_[host].device.get(), frame.data(), frame.size()) < 0) ++lost_;
}

void Cable::Receive(std::size_t from, const char* frame, std::size_t size, Clock::time_point now) {
  const std::lock_guard lock(mutex_);
  for (std::size_t to = 0; to < ports_.size(); ++to) {
    if (to == from) continue;
    ++sent_;
    if (now < ports_[from].cut_until || now < ports_[to].cut_until || Draw(quality_.lost)) {
      ++lost_;
      continue;
    }
    const auto due =
        now + quality_.delay + (Draw(quality_.overtaken) ? quality_.held : quality_.held * 0);
    const std::string copy(frame, size);
    if (due == now) {
      Send(to, copy);
    } else {
      held_.push({due, number_++, to, copy});
    }
    if (Draw(quality_.repeated)) held_.push({due + kRepeatedAfter, number_++, to, copy});
  }
}

void Cable::Forward() {
  sched_param parameters{.sched_priority = 80};  // where it is allowed: a switch is never busy
  (void)::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
  std::vector<pollfd> wanted;
  for (const Port& port : ports_) wanted.push_back({port.device.get(), POLLIN, 0});
  wanted.push_back({wake_.get(), POLLIN, 0});
  std::vector<char> buffer(kLargestFrame);
  while (wanted.back().revents == 0) {
    timespec wait{};
    if (!held_.empty()) {
      const auto left = std::max(held_.top().due - Clock::now(), Clock::duration::zero());
      wait.tv_sec = std::chrono::duration_cast<std::chrono::seconds>(left).count();
      wait.tv_nsec = static_cast<long>((left % std::chrono::seconds(1)).count());
    }
    if (::ppoll(wanted.data(), wanted.size(), held_.empty() ? nullptr : &wait, nullptr) < 0) {
      continue;
    }
    const auto now = Clock::now();
    for (; !held_.empty() && held_.top().due <= now; held_.pop()) {
      Send(held_.top().host, held_.top().frame);
    }
    for (std::size_t from = 0; from < ports_.size(); ++from) {
      if (wanted[from].revents == 0) continue;
      const ssize_t size = ::read(wanted[from].fd, buffer.data(), buffer.size());
      if (size > 0) Receive(from, buffer.data(), static_cast<std::size_t>(size), now);
    }
  }
}

CabledHosts::CabledHosts(std::size_t count, std::uint32_t seed) {
  std::vector<pid_t> pids;
  for (std::size_t host = 0; host < count; ++host) {
    hosts_.push_back(std::make_unique<TestHost>(Name(host)));
    if (!hosts_.back()->why_not().empty()) return;
    pids.push_back(hosts_.back()->pid());
  }
  cable_ = std::make_unique<Cable>(pids, seed);
  if (!cable_->why_not().empty()) return;
  for (std::size_t host = 0; host < count; ++host) {
    TestHost& here = *hosts_[host];
    here.Set({"sh", "-c", "echo 1 > /proc/sys/net/ipv6/conf/wire0/disable_ipv6"});
    here.Set({"ip", "address", "add", Address(host) + "/24", "dev", kInterface});
    here.Set({"ip", "link", "set", kInterface, "up"});
  }
}

std::string CabledHosts::why_not() const {
  for (const auto& host : hosts_) {
    if (!host->why_not().empty()) return host->why_not();
  }
  return cable_ == nullptr ? "hosts" : cable_->why_not();
}

}  // namespace sinew::testing

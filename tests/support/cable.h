// A switch between test hosts, with a cable to each that loses, delays, repeats and cuts what a
// test asks for: the network emulation of kernels (netem) is not in every one of them.
//
// Each host gets the interface "wire0", an Ethernet device whose frames a thread of this process
// forwards (TAP, /dev/net/tun). Every draw is of one seeded generator, a frame to several hosts is
// drawn for each of them. Needs root. Any thread may change it.
#pragma once

#include <sys/types.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <queue>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "components/base/config/descriptor.h"
#include "tests/support/program.h"
#include "tests/support/test_host.h"

namespace sinew::testing {

// What happens to the frames of every cable; shares are of 0 to 1, of frames.
struct CableQuality {
  double lost = 0.0;
  double repeated = 0.0;   // a second time, a millisecond later
  double overtaken = 0.0;  // by those that follow within `held`
  std::chrono::microseconds delay{0};
  std::chrono::microseconds held{10'000};
};

class Cable {
 public:
  // Of the hosts' network namespaces; these outlive it.
  explicit Cable(const std::vector<pid_t>& hosts, std::uint32_t seed = 1);
  ~Cable();
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  const std::string& why_not() const { return why_not_; }  // empty: it is there

  void Set(const CableQuality& quality);
  // Nothing passes to or from this host, from now for as long, or until it is mended.
  void Cut(std::size_t host, std::chrono::milliseconds duration = std::chrono::hours(24));
  void Mend(std::size_t host) { Cut(host, std::chrono::milliseconds(0)); }

  // Frames that came in, times the hosts that they were for; and those among them that were lost.
  std::uint64_t sent() const { return sent_; }
  std::uint64_t lost() const { return lost_; }

 private:
  using Clock = std::chrono::steady_clock;
  struct Held {
    Clock::time_point due;
    std::uint64_t number;
    std::size_t host;
    std::string frame;
    bool operator<(const Held& other) const {  // the top of a queue is its greatest
      return due != other.due ? due > other.due : number > other.number;
    }
  };
  struct Port {
    config::Descriptor device;
    Clock::time_point cut_until{};
  };

  void Forward();
  void Receive(std::size_t from, const char* frame, std::size_t size, Clock::time_point now);
  bool Draw(double share);
  void Send(std::size_t host, const std::string& frame);

  std::string why_not_;
  std::vector<Port> ports_;
  config::Descriptor wake_;
  std::mutex mutex_;  // of quality_ and the ports' cuts
  CableQuality quality_;
  std::mt19937 random_;  // of the thread, as the rest
  std::priority_queue<Held> held_;
  std::uint64_t number_ = 0;
  std::atomic<std::uint64_t> sent_{0}, lost_{0};
  std::thread thread_;
};

// This thread's sockets and host name, and those of threads that it starts, are of a test host for
// as long as this lives: a DDS participant made meanwhile is on that host.
class OnHost {
 public:
  explicit OnHost(pid_t host);  // throws std::runtime_error
  ~OnHost();
  OnHost(const OnHost&) = delete;
  OnHost& operator=(const OnHost&) = delete;

 private:
  config::Descriptor network_, name_;  // of before
};

// Hosts "host0", "host1", ... with a cable between them.
class CabledHosts {
 public:
  explicit CabledHosts(std::size_t count, std::uint32_t seed = 1);

  std::string why_not() const;
  Cable& cable() { return *cable_; }
  pid_t pid(std::size_t host) const { return hosts_[host]->pid(); }
  static std::string Name(std::size_t host) { return "host" + std::to_string(host); }
  static std::string Address(std::size_t host) { return "10.54.1." + std::to_string(host + 1); }
  std::vector<std::string> On(std::size_t host, const std::vector<std::string>& line) const {
    return hosts_[host]->Line(line);
  }

 private:
  std::vector<std::unique_ptr<TestHost>> hosts_;
  std::unique_ptr<Cable> cable_;
};

}  // namespace sinew::testing

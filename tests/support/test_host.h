// A host of its own, as namespaces of this machine: its name, network (loopback as a new machine
// has it, without multicast flag or route), and /dev/shm, because shared memory ends at a host.
// TwoHosts: two with a cable between them, the interface "wire0". Needs root. Nothing outside is
// changed.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tests/support/program.h"

namespace sinew::testing {

class TestHost {
 public:
  explicit TestHost(const std::string& name = "host")
      // Private first: a tmpfs over a shared mount would be one over this machine's /dev/shm.
      : holder_({"unshare", "--net", "--uts", "--mount", "--propagation", "unchanged", "--", "sh",
                 "-c",
                 "hostname \"$0\" && mount --make-private /dev/shm && "
                 "mount -t tmpfs host /dev/shm && ip link set lo up && echo ready && "
                 "exec sleep 600",
                 name}) {
    if (!holder_.WaitForText("ready", std::chrono::seconds(10))) {
      why_not_ = "namespaces: " + holder_.error();
    }
  }

  const std::string& why_not() const { return why_not_; }  // empty: it is there
  pid_t pid() const { return holder_.pid(); }

  // The command line that runs a program there, for Program and Run; it becomes that program. -r
  // and -w: in root and folder of the host's own process, which after chroot is not that of its
  // namespace.
  std::vector<std::string> Line(const std::vector<std::string>& line) const {
    std::vector<std::string> words = {
        "nsenter", "-t", std::to_string(pid()), "-n", "-u", "-m", "-r", "-w", "--"};
    words.insert(words.end(), line.begin(), line.end());
    return words;
  }

  // For setting it up: a failure is why_not().
  void Set(const std::vector<std::string>& line) {
    if (!why_not_.empty()) return;
    const Finished finished = Run(Line(line));
    if (finished.exit_code != 0) why_not_ = line.front() + ": " + finished.error;
  }

  // A disk of that size; its folder is there for programs of this host only.
  std::string MakeDisk(const std::string& size) {
    Set({"mkdir", "/dev/shm/disk"});
    Set({"mount", "-t", "tmpfs", "-o", "size=" + size, "disk", "/dev/shm/disk"});
    return "/dev/shm/disk";
  }

 private:
  Program holder_;
  std::string why_not_;
};

class TwoHosts {
 public:
  TwoHosts() {
    const std::string other = std::to_string(hosts_[1].pid());
    if (!hosts_[1].why_not().empty()) return;
    hosts_[0].Set(
        {"ip", "link", "add", "wire0", "type", "veth", "peer", "name", "wire0", "netns", other});
    for (int host : {0, 1}) {
      TestHost& here = hosts_[static_cast<std::size_t>(host)];
      // IPv6 announces itself; what leaves the host is counted.
      here.Set({"sh", "-c", "echo 1 > /proc/sys/net/ipv6/conf/wire0/disable_ipv6"});
      here.Set({"ip", "address", "add", Address(host) + "/24", "dev", "wire0"});
      here.Set({"ip", "link", "set", "wire0", "up"});
    }
    // The kernel reports a carrier up to a second later.
    for (TestHost& here : hosts_) {
      here.Set({"sh", "-c",
                "for i in $(seq 200); do ip link show wire0 | grep -q 'state UP' && exit 0; "
                "sleep 0.05; done; exit 1"});
    }
  }

  std::string why_not() const { return hosts_[0].why_not() + hosts_[1].why_not(); }
  pid_t pid(int host) const { return hosts_[static_cast<std::size_t>(host)].pid(); }
  static std::string Name(int host) { return "host" + std::to_string(host); }
  static std::string Address(int host) { return "10.54.0." + std::to_string(host + 1); }
  std::vector<std::string> On(int host, const std::vector<std::string>& line) const {
    return hosts_[static_cast<std::size_t>(host)].Line(line);
  }

 private:
  std::array<TestHost, 2> hosts_ = {TestHost(Name(0)), TestHost(Name(1))};
};

}  // namespace sinew::testing

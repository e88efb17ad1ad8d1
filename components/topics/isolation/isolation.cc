#include "components/topics/isolation/isolation.h"

#include <fcntl.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>
#include <net/if.h>
#include <pwd.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>

#include "components/base/config/config.h"
#include "components/base/config/descriptor.h"
#include "components/base/config/program_file.h"

namespace sinew::isolation {

namespace {

namespace fs = std::filesystem;
using config::Descriptor;

// The name that the kernel shows of a holder (15 characters), and its command line.
constexpr char kHolderName[] = "sinew-isolate";
constexpr char kCommand[] = "isolate";
constexpr char kDomainOption[] = "--domain";
constexpr char kMoveOption[] = "--move";

[[noreturn]] void Fail(const std::string& what) {
  throw UsageError("isolation: " + what + ": " + std::strerror(errno));
}

Descriptor Open(const fs::path& path) {
  Descriptor out(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (out.get() < 0) Fail(path.string());
  return out;
}

std::vector<std::string> CommandLineOf(const fs::path& process) {
  std::ifstream in(process / "cmdline");
  std::vector<std::string> words;
  for (std::string word; std::getline(in, word, '\0');) words.push_back(word);
  return words;
}

std::optional<Holder> AsHolder(const fs::path& process) {
  std::string name;
  std::ifstream in(process / "comm");
  if (!std::getline(in, name) || name != kHolderName) return std::nullopt;
  struct stat status {};
  if (::stat(process.c_str(), &status) != 0) return std::nullopt;
  const std::vector<std::string> words = CommandLineOf(process);
  if (words.size() < 5 || words[1] != kCommand || words[3] != kDomainOption) return std::nullopt;
  try {
    return Holder{std::stoi(process.filename().string()), words[2], std::stoi(words[4]),
                  status.st_uid};
  } catch (const std::logic_error&) {  // no number
    return std::nullopt;
  }
}

std::string NamesOf(const std::vector<Holder>& holders) {
  std::string out;
  for (const Holder& holder : holders) out += (out.empty() ? "" : ", ") + holder.deployment;
  return out.empty() ? "none" : out;
}

bool IsSameNamespace(const Descriptor& one, const fs::path& other) {
  struct stat a {
  }, b{};
  return ::fstat(one.get(), &a) == 0 && ::stat(other.c_str(), &b) == 0 && a.st_ino == b.st_ino;
}

void WriteMap(const char* file, const std::string& text) {
  std::ofstream out(file);
  if (!(out << text).flush()) Fail(file);
}

// The user keeps his number inside.
void MapUser(uid_t user, gid_t group) {
  WriteMap("/proc/self/setgroups", "deny");
  WriteMap("/proc/self/uid_map", std::to_string(user) + " " + std::to_string(user) + " 1");
  WriteMap("/proc/self/gid_map", std::to_string(group) + " " + std::to_string(group) + " 1");
}

// Mounts that the host makes later are seen inside as well, those made inside are not seen outside.
// In a changed root the root is no mount, and /dev/shm alone matters.
void OwnSharedMemory() {
  if (::mount(nullptr, "/", nullptr, MS_REC | MS_SLAVE, nullptr) != 0 &&
      ::mount(nullptr, "/dev/shm", nullptr, MS_PRIVATE, nullptr) != 0) {
    Fail("/dev/shm cannot be made private");
  }
  if (::mount("sinew", "/dev/shm", "tmpfs", MS_NOSUID | MS_NODEV, "mode=1777") != 0) {
    Fail("no /dev/shm of its own");
  }
}

}  // namespace

namespace internal {

// A network by what was opened in it: sockets stay there, wherever their process goes.
struct OpenNetwork {
  Descriptor file{Open("/proc/self/ns/net")};
  Descriptor netlink{::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, NETLINK_ROUTE)};
  Descriptor control{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};

  // False, with errno: refused, or no such interface.
  bool Ask(unsigned long what, const std::string& interface, ifreq* request) const {
    interface.copy(request->ifr_name, IFNAMSIZ - 1);
    return ::ioctl(control.get(), what, request) == 0;
  }
  std::optional<ifreq> Get(unsigned long what, const std::string& interface) const {
    ifreq request{};
    return Ask(what, interface, &request) ? std::optional(request) : std::nullopt;
  }
  bool IsRunning(const std::string& interface) const {
    const auto flags = Get(SIOCGIFFLAGS, interface);
    return flags && (flags->ifr_flags & IFF_RUNNING) != 0;
  }
  void SetUp(const std::string& interface) const {
    ifreq request{};
    if (Ask(SIOCGIFFLAGS, interface, &request)) {
      request.ifr_flags = static_cast<short>(request.ifr_flags | IFF_UP);
      if (Ask(SIOCSIFFLAGS, interface, &request)) return;
    }
    Fail(interface + " cannot be set up");
  }
};

}  // namespace internal

namespace {

using internal::OpenNetwork;

// rtnetlink(7), IFLA_NET_NS_FD. False, with errno: the kernel refuses.
bool ChangeNetwork(const OpenNetwork& from, int index, const OpenNetwork& to) {
  struct {
    nlmsghdr header;
    ifinfomsg interface;
    rtattr attribute;
    int descriptor;
  } request{};
  request.header.nlmsg_len = sizeof request;
  request.header.nlmsg_type = RTM_NEWLINK;
  request.header.nlmsg_flags = NLM_F_REQUEST | NLM_F_ACK;
  request.interface.ifi_family = AF_UNSPEC;
  request.interface.ifi_index = index;
  request.attribute.rta_type = IFLA_NET_NS_FD;
  request.attribute.rta_len = RTA_LENGTH(sizeof request.descriptor);
  request.descriptor = to.file.get();
  if (::send(from.netlink.get(), &request, sizeof request, 0) != sizeof request) return false;
  std::array<char, 4096> answer{};
  if (::recv(from.netlink.get(), answer.data(), answer.size(), 0) <
      static_cast<ssize_t>(sizeof(nlmsghdr) + sizeof(nlmsgerr))) {
    return false;
  }
  nlmsgerr error{};
  std::memcpy(&error, answer.data() + sizeof(nlmsghdr), sizeof error);
  errno = -error.error;
  return error.error == 0;
}

// With its first IPv4 address, and up there where it was up. Nothing, where `from` has none of that
// name.
void Move(const std::string& interface, const OpenNetwork& from, const OpenNetwork& to) {
  const auto index = from.Get(SIOCGIFINDEX, interface), flags = from.Get(SIOCGIFFLAGS, interface);
  if (!index || !flags) return;
  auto address = from.Get(SIOCGIFADDR, interface), mask = from.Get(SIOCGIFNETMASK, interface);
  if (!ChangeNetwork(from, index->ifr_ifindex, to)) Fail(interface + " cannot be moved");
  if (address && mask &&
      !(to.Ask(SIOCSIFADDR, interface, &*address) && to.Ask(SIOCSIFNETMASK, interface, &*mask))) {
    Fail(interface + " loses its address");
  }
  if ((flags->ifr_flags & IFF_UP) != 0) to.SetUp(interface);
}

std::vector<Holder> HoldersOfAll() {
  std::vector<Holder> out;
  std::error_code ignored;
  for (const auto& process : fs::directory_iterator("/proc", ignored)) {
    if (const auto holder = AsHolder(process.path())) out.push_back(*holder);
  }
  std::sort(out.begin(), out.end(),
            [](const Holder& a, const Holder& b) { return a.deployment < b.deployment; });
  return out;
}

bool IsInside(const Holder& holder) {
  return IsSameNamespace(Open("/proc/self/ns/net"),
                         "/proc/" + std::to_string(holder.pid) + "/ns/net");
}

std::string NameOf(uid_t user) {
  const passwd* entry = ::getpwuid(user);
  return entry == nullptr ? std::to_string(user) : entry->pw_name;
}

}  // namespace

std::vector<Holder> Holders() {
  std::vector<Holder> out = HoldersOfAll();
  std::erase_if(out, [](const Holder& holder) { return holder.user != ::geteuid(); });
  return out;
}

std::optional<Holder> Inside() {
  for (const Holder& holder : HoldersOfAll()) {
    if (IsInside(holder)) return holder;
  }
  return std::nullopt;
}

std::string OthersIn(int domain_id) {
  std::string out;
  for (const Holder& holder : HoldersOfAll()) {
    if (holder.domain_id != domain_id) continue;
    const bool own = holder.user == ::geteuid();
    if (own && IsInside(holder)) continue;
    out += "; isolated there: '" + holder.deployment + "' " +
           (own ? "(--deployment " + holder.deployment + ")"
                : "of user " + NameOf(holder.user) + ", whose programs alone reach it");
  }
  return out;
}

std::optional<Holder> Chosen(const std::string& chosen, int domain_id) {
  if (chosen == "none") return std::nullopt;
  std::vector<Holder> running = Holders();
  if (!chosen.empty()) {
    for (const Holder& holder : running) {
      if (holder.deployment == chosen) return holder;
    }
    throw UsageError("--deployment " + chosen +
                     ": no isolated deployment of that name runs, expected one of this user's: " +
                     NamesOf(running));
  }
  std::erase_if(running, [&](const Holder& holder) { return holder.domain_id != domain_id; });
  if (running.size() > 1) {
    throw UsageError("several isolated deployments run in domain " + std::to_string(domain_id) +
                     ", expected --deployment with one of " + NamesOf(running) +
                     ", or none for the host's own network");
  }
  if (running.empty()) return std::nullopt;
  return running.front();
}

void Enter(const Holder& holder) {
  config::ProgramFile();
  const fs::path process = "/proc/" + std::to_string(holder.pid);
  const Descriptor user = Open(process / "ns/user"), network = Open(process / "ns/net"),
                   mounts = Open(process / "ns/mnt"), root = Open(process / "root");
  if (IsSameNamespace(network, "/proc/self/ns/net")) return;
  const fs::path folder = fs::current_path();
  if (!IsSameNamespace(user, "/proc/self/ns/user") && ::setns(user.get(), CLONE_NEWUSER) != 0) {
    Fail("the user namespace of " + holder.deployment);
  }
  if (::setns(network.get(), CLONE_NEWNET) != 0) Fail("the network of " + holder.deployment);
  if (::setns(mounts.get(), CLONE_NEWNS) != 0) Fail("the mounts of " + holder.deployment);
  // The kernel changes root and folder to those of the namespace, which after chroot are others.
  if (::fchdir(root.get()) != 0 || ::chroot(".") != 0 || ::chdir(folder.c_str()) != 0) {
    Fail(folder.string() + " in the mounts of " + holder.deployment);
  }
  ::setenv("SINEW_DEPLOYMENT", "none", 1);  // what it executes is there already
}

struct Isolation::Impl {
  std::vector<std::string> interfaces;
  std::optional<OpenNetwork> host, own;
};

Isolation::Isolation(const std::string& deployment, const std::vector<std::string>& interfaces,
                     Network network)
    : impl_(std::make_unique<Impl>()) {
  for (const Holder& holder : Holders()) {
    if (holder.deployment != deployment) continue;
    throw UsageError("isolation: a deployment '" + deployment + "' runs already (process " +
                     std::to_string(holder.pid) + "), expected a name of its own");
  }
  impl_->interfaces = interfaces;
  if (network == Network::kGiven) {
    impl_->own.emplace();
    const Descriptor host = Open("/proc/1/ns/net");
    if (IsSameNamespace(host, "/proc/self/ns/net")) {
      throw UsageError(
          "isolation: this process is in process 1's network, expected PrivateNetwork=");
    }
    if (::setns(host.get(), CLONE_NEWNET) != 0) Fail("the network of process 1");
    impl_->host.emplace();
    if (::setns(impl_->own->file.get(), CLONE_NEWNET) != 0) Fail("the network that was given");
  } else {
    impl_->host.emplace();
    for (const std::string& name : interfaces) {
      if (!impl_->host->Get(SIOCGIFINDEX, name)) Fail("interface " + name);
    }
    MakeNew(interfaces);
    impl_->own.emplace();
  }
  impl_->own->SetUp("lo");
  MoveIn();
}

void Isolation::MakeNew(const std::vector<std::string>& interfaces) {
  const uid_t user = ::geteuid();
  const gid_t group = ::getegid();
  if (user != 0 && !interfaces.empty()) {
    throw UsageError("isolation: " + interfaces.front() + " can be moved by root only");
  }
  if (::unshare((user == 0 ? 0 : CLONE_NEWUSER) | CLONE_NEWNET | CLONE_NEWNS) != 0) {
    Fail("no namespaces for this user, expected root, or user namespaces for everybody");
  }
  if (user != 0) MapUser(user, group);
  OwnSharedMemory();
}

void Isolation::MoveIn() {
  // A carrier comes back within a second on cables, and some seconds later on Ethernet.
  constexpr auto kCarrier = std::chrono::seconds(5);
  for (const std::string& name : impl_->interfaces) {
    const bool ran = impl_->host->IsRunning(name);
    Move(name, *impl_->host, *impl_->own);
    const auto end = std::chrono::steady_clock::now() + kCarrier;
    while (ran && !impl_->own->IsRunning(name) && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
}

Isolation::~Isolation() {
  for (const std::string& name : impl_->interfaces) {
    try {
      Move(name, *impl_->own, *impl_->host);
    } catch (const UsageError&) {
      // The kernel gives physical ones back with the last process inside.
    }
  }
}

std::vector<std::string> HolderArguments(const std::string& deployment, int domain_id,
                                         const std::vector<std::string>& interfaces) {
  std::vector<std::string> out = {kCommand, deployment, kDomainOption, std::to_string(domain_id)};
  for (const std::string& name : interfaces) out.insert(out.end(), {kMoveOption, name});
  return out;
}

void BecomeHolder() { ::prctl(PR_SET_NAME, kHolderName); }

}  // namespace sinew::isolation

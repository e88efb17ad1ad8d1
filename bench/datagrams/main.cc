// Mutated RTPS on every UDP port of running participants: bench/datagrams/README.md.
#include <arpa/inet.h>
#include <linux/if_ether.h>
#include <net/if.h>
#include <netinet/in.h>
#include <netinet/ip.h>
#include <netinet/udp.h>
#include <netpacket/packet.h>
#include <poll.h>
#include <sinew_idl/joint.h>
#include <spdlog/spdlog.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "components/topics/node/filtered_transport.h"
#include "components/topics/node/node.h"

namespace {

using namespace sinew;
using Clock = std::chrono::steady_clock;
using Datagram = std::vector<std::uint8_t>;

constexpr char kDiscoveryGroup[] = "239.255.0.1";
constexpr std::size_t kHeader = 20, kPrefix = 8;  // of RTPS; where the sender's prefix begins

class Socket {
 public:
  Socket(int family, int type, int protocol)
      : fd_(::socket(family, type | SOCK_CLOEXEC, protocol)) {
    if (fd_ < 0) throw std::runtime_error("no socket (capturing needs root)");
  }
  ~Socket() { ::close(fd_); }
  Socket(const Socket&) = delete;
  Socket& operator=(const Socket&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

// Ports of the UDP sockets of this process that are read: from some, DDS only sends.
std::set<int> ReadPorts() {
  const Socket from(AF_INET, SOCK_DGRAM, 0);
  std::map<int, int> fds;  // by port
  for (int fd = 0; fd < 1024; ++fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    int type = 0;
    socklen_t type_size = sizeof type;
    if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM) continue;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    if (address.sin_family != AF_INET || address.sin_port == 0) continue;
    if (!fds.emplace(ntohs(address.sin_port), fd).second) continue;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const std::uint8_t nothing = 0;
    ::sendto(from.fd(), &nothing, 1, 0, reinterpret_cast<const sockaddr*>(&address),
             sizeof address);
  }
  const auto end = Clock::now() + std::chrono::seconds(1);
  std::set<int> out;
  while (Clock::now() < end && out.size() < fds.size()) {
    for (const auto& [port, fd] : fds) {
      int waiting = 0;
      if (::ioctl(fd, FIONREAD, &waiting) == 0 && waiting == 0) out.insert(port);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return out;
}

// A participant that writes joint_command and one that reads it, as a robot has them.
class Pair {
 public:
  Pair(const node::Options& common, const std::string& name)
      : writer_node_(Named(common, name + "_writer")),
        reader_node_(Named(common, name + "_reader")),
        writer_(writer_node_.MakeWriter(node::kJointCommand)),
        reader_(reader_node_.MakeReader(node::kJointCommand)) {}

  void Write() { (void)writer_.Write(msg::JointCommand()); }
  // A sample of this pair's own writer arrives within the limit.
  bool Talks() {
    const auto end = Clock::now() + std::chrono::seconds(20);
    msg::JointCommand command;
    command.header.session_id = reinterpret_cast<std::uintptr_t>(this);
    while (Clock::now() < end) {
      command.header.tick = ++tick_;
      (void)writer_.Write(command);
      while (const auto heard = reader_.WaitNext(std::chrono::milliseconds(20))) {
        if (heard->header.session_id == command.header.session_id) return true;
      }
    }
    return false;
  }

 private:
  static node::Options Named(node::Options options, const std::string& name) {
    options.component = options.name = name;
    return options;
  }
  node::Node writer_node_, reader_node_;
  node::Writer<msg::JointCommand> writer_;
  node::Reader<msg::JointCommand> reader_;
  std::uint64_t tick_ = 0;
};

// Discovery, handshakes and samples are over by then; what follows are heartbeats.
constexpr std::chrono::seconds kCapture{8};

// What passes on loopback between participants while a pair finds itself: discovery, handshakes
// where there is DDS security, acknowledgements and samples.
std::vector<Datagram> Captured(const node::Options& options, std::size_t most) {
  const Socket socket(AF_PACKET, SOCK_DGRAM, htons(ETH_P_IP));
  sockaddr_ll loopback{};
  loopback.sll_family = AF_PACKET;
  loopback.sll_protocol = htons(ETH_P_IP);
  loopback.sll_ifindex = static_cast<int>(::if_nametoindex("lo"));
  ::bind(socket.fd(), reinterpret_cast<const sockaddr*>(&loopback), sizeof loopback);
  Pair pair(options, "seed");
  if (!pair.Talks()) throw std::runtime_error("the participants do not find each other");
  for (int k = 0; k < 20; ++k) pair.Write();
  std::vector<Datagram> out;
  std::set<Datagram> seen;
  pollfd wait{socket.fd(), POLLIN, 0};
  std::array<std::uint8_t, 65536> bytes{};
  const auto end = Clock::now() + kCapture;
  while (out.size() < most && Clock::now() < end && ::poll(&wait, 1, 1500) == 1) {
    const ssize_t size = ::recv(socket.fd(), bytes.data(), bytes.size(), 0);
    if (size < static_cast<ssize_t>(sizeof(iphdr) + sizeof(udphdr) + kHeader)) continue;
    iphdr ip{};
    std::memcpy(&ip, bytes.data(), sizeof ip);
    if (ip.protocol != IPPROTO_UDP) continue;
    const std::size_t begin = 4u * ip.ihl + sizeof(udphdr);
    if (begin + kHeader > static_cast<std::size_t>(size)) continue;
    if (std::memcmp(bytes.data() + begin, "RTPS", 4) != 0) continue;
    Datagram datagram(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + size);
    if (seen.insert(datagram).second) out.push_back(std::move(datagram));
  }
  return out;
}

// Where a little-endian announcement has the seconds of its lease. 0: it is none.
std::size_t LeaseOf(const Datagram& datagram) {
  constexpr std::array<std::uint8_t, 4> kHead = {0x02, 0x00, 8, 0};  // parameter, length
  const auto at =
      std::search(datagram.begin() + kHeader, datagram.end(), kHead.begin(), kHead.end());
  return datagram.end() - at < 12 ? 0 : static_cast<std::size_t>(at - datagram.begin()) + 4;
}

// Bytes, words and lengths behind the header; of half of them the sender is a stranger. All but
// `whole` of them are broken besides, so that fewer pass the filter. `leases`: instead of a part of
// them, announcements of strangers that end at once, or in the next seconds.
class Mutator {
 public:
  Mutator(std::uint32_t seed, double whole, double leases)
      : random_(seed), whole_(whole), leases_(leases) {}

  Datagram Of(const std::vector<Datagram>& seeds) {
    if (leases_(random_)) return ShortLived(seeds);
    Datagram out = Mutated(seeds);
    if (!whole_(random_)) Break(&out);
    return out;
  }

 private:
  Datagram Mutated(const std::vector<Datagram>& seeds) {
    Datagram out = seeds[random_() % seeds.size()];
    if (random_() % 2 == 0) Replace(&out, kPrefix, 12);
    const unsigned changes = random_() % 5;
    for (unsigned k = 0; k < changes && out.size() > kHeader; ++k) Change(&out);
    if (random_() % 50 == 0) out.resize(random_() % (out.size() + 1));
    if (random_() % 50 == 0) {
      const Datagram& more = seeds[random_() % seeds.size()];
      out.insert(out.end(), more.begin() + kHeader, more.end());
    }
    return out;
  }
  Datagram ShortLived(const std::vector<Datagram>& seeds) {
    for (;;) {
      Datagram out = seeds[random_() % seeds.size()];
      const std::size_t lease = LeaseOf(out);
      if (lease == 0) continue;
      const Datagram sender(out.begin() + kPrefix, out.begin() + kPrefix + 12);
      Datagram stranger = sender;
      Replace(&stranger, 0, stranger.size());
      // In the header and in the GUID that is announced.
      for (auto at = out.begin(); at != out.end(); at += 12) {
        at = std::search(at, out.end(), sender.begin(), sender.end());
        if (at == out.end()) break;
        std::copy(stranger.begin(), stranger.end(), at);
      }
      const std::uint32_t seconds = random_() % 4 == 0 ? 1 + random_() % 3 : 0;
      const std::uint32_t fraction = random_() % 2 == 0 ? 0 : random_() % (1u << 22);  // 1 ms
      std::memcpy(out.data() + lease, &seconds, 4);
      std::memcpy(out.data() + lease + 4, &fraction, 4);
      return out;
    }
  }
  // From its header or its first submessage on: random, cut off, of another vendor, of a length
  // that is wrong.
  void Break(Datagram* datagram) {
    const std::size_t size = datagram->size();
    switch (random_() % 4) {
      case 0:
        Replace(datagram, random_() % (kHeader + 4), size);
        break;
      case 1:
        datagram->resize(random_() % (size + 1));
        break;
      case 2:
        if (size > kHeader) (*datagram)[kHeader] = static_cast<std::uint8_t>(0x80 | random_());
        break;
      default:
        Replace(datagram, kHeader + 2, 2);
    }
  }
  void Replace(Datagram* datagram, std::size_t at, std::size_t count) {
    for (std::size_t k = at; k < std::min(at + count, datagram->size()); ++k) {
      (*datagram)[k] = static_cast<std::uint8_t>(random_());
    }
  }
  void Change(Datagram* datagram) {
    const std::size_t at = kHeader + random_() % (datagram->size() - kHeader);
    std::uint8_t& byte = (*datagram)[at];
    switch (random_() % 4) {
      case 0:
        byte = static_cast<std::uint8_t>(random_());
        break;
      case 1:
        byte = static_cast<std::uint8_t>(byte ^ (1u << random_() % 8));
        break;
      case 2:  // identifiers, flags and small lengths
        byte = static_cast<std::uint8_t>(random_() % 0x40);
        break;
      default:
        constexpr std::array<std::uint32_t, 5> kWords = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff};
        const std::uint32_t word = kWords[random_() % kWords.size()];
        const std::size_t aligned = at / 4 * 4;
        if (aligned + 4 <= datagram->size()) std::memcpy(datagram->data() + aligned, &word, 4);
    }
  }

  std::mt19937 random_;
  std::bernoulli_distribution whole_, leases_;
};

class Sender {
 public:
  explicit Sender(int domain) {
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(socket_.fd(), IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
    const int discovery_port = 7400 + 250 * domain;  // RTPS 2.5, 9.6.2
    for (const int port : ReadPorts()) Add("127.0.0.1", port);
    Add(kDiscoveryGroup, discovery_port);
  }

  // The ports in turn: every one gets as many, some in a row, so that a thread that was woken finds
  // more than one.
  void Send(const Datagram& datagram) {
    constexpr std::size_t kInARow = 8;
    const sockaddr_in& to = addresses_[next_++ / kInARow % addresses_.size()];
    ::sendto(socket_.fd(), datagram.data(), datagram.size(), 0,
             reinterpret_cast<const sockaddr*>(&to), sizeof to);
  }

 private:
  void Add(const char* host, int port) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, host, &address.sin_addr);
    addresses_.push_back(address);
  }

  const Socket socket_{AF_INET, SOCK_DGRAM, 0};
  std::vector<sockaddr_in> addresses_;
  std::size_t next_ = 0;
};

struct SoakOptions {
  node::Options node;
  std::uint64_t count = 100'000'000;
  std::uint32_t seed = 1;
  double whole = 1.0;
  double leases = 0.0;
};

// So many are on their way at most: the sockets hold some hundreds each.
constexpr std::uint64_t kInFlight = 200;
constexpr std::uint64_t kBetweenPairs = 2'000'000;

int Soak(const SoakOptions& options) {
  const std::vector<Datagram> seeds = Captured(options.node, 400);
  std::printf("%zu datagrams captured\n", seeds.size());
  std::fflush(stdout);
  Pair attacked(options.node, "attacked");
  if (!attacked.Talks()) throw std::runtime_error("the participants do not find each other");
  Sender sender(options.node.domain_id);
  Mutator mutator(options.seed, options.whole, options.leases);
  const auto began = Clock::now();
  const node::internal::DatagramCounts first = node::internal::ReceivedDatagrams();
  std::uint64_t received = 0, sent = 0, next_pair = kBetweenPairs;
  auto last_news = Clock::now();
  while (received < options.count) {
    if (sent < received + kInFlight) {
      sender.Send(mutator.Of(seeds));
      ++sent;
    } else {
      std::this_thread::yield();
    }
    const std::uint64_t now = node::internal::ReceivedDatagrams().received - first.received;
    if (now != received) last_news = Clock::now();
    received = now;
    if (Clock::now() - last_news > std::chrono::milliseconds(50)) sent = received;  // lost ones
    if (received < next_pair) continue;
    next_pair += kBetweenPairs;
    // Newcomers find each other beside it.
    Pair pair(options.node, "newcomer");
    if (!pair.Talks()) {
      std::printf("after %llu: newcomers do not find each other\n",
                  static_cast<unsigned long long>(received));
      return 1;
    }
  }
  const node::internal::DatagramCounts last = node::internal::ReceivedDatagrams();
  const std::uint64_t dropped = last.dropped - first.dropped;
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  std::printf(
      "%llu received, %llu dropped, %llu passed the filter; %.0f s, %.0f a second; no end\n",
      static_cast<unsigned long long>(received), static_cast<unsigned long long>(dropped),
      static_cast<unsigned long long>(received - dropped), seconds,
      static_cast<double>(received) / seconds);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  SoakOptions options;
  options.node.deployment = "none";
  CLI::App app("Mutated RTPS on every port of running participants");
  node::AddDomainOptions(app, &options.node);
  app.add_option("--count", options.count, "Datagrams that the participants receive");
  app.add_option("--seed", options.seed, "Of the mutations");
  app.add_option("--whole", options.whole, "Share that is not broken besides, most of it passes")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--leases", options.leases, "Share of announcements with a short lease instead")
      ->check(CLI::Range(0.0, 1.0));
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::off);
  try {
    return Soak(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "datagram_soak: %s\n", error.what());
    return 1;
  }
}

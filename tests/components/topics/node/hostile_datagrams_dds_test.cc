// Hostile datagrams on every UDP port of running participants: none of them ends, and they go on
// talking to each other. Sent to loopback alone.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sinew_idl/joint.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <random>
#include <set>

#include "components/topics/node/filtered_transport.h"
#include "components/topics/node/node.h"
#include "tests/components/topics/node/datagrams.h"
#include "tests/support/temporary_folder.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using namespace sinew::node::testing;

constexpr char kDiscoveryGroup[] = "239.255.0.1";
constexpr int kDomain = 164;
constexpr int kDiscoveryPort = 7400 + 250 * kDomain;  // RTPS 2.5, 9.6.2

Options InRealTime(const std::string& name, const std::filesystem::path& key = {}) {
  Options options;
  options.key_path = key;
  options.component = options.name = name;
  options.domain_id = kDomain;
  options.mode = TimeMode::kRealtime;
  return options;
}

sockaddr_in AddressOf(const char* host, int port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(static_cast<std::uint16_t>(port));
  inet_pton(AF_INET, host, &out.sin_addr);
  return out;
}

// Ports of the UDP sockets of this process.
std::set<int> OpenPorts() {
  std::set<int> out;
  for (int fd = 0; fd < 1024; ++fd) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    int type = 0;
    socklen_t type_size = sizeof type;
    if (getsockopt(fd, SOL_SOCKET, SO_TYPE, &type, &type_size) != 0 || type != SOCK_DGRAM) continue;
    if (getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    if (address.sin_family == AF_INET && address.sin_port != 0) out.insert(ntohs(address.sin_port));
  }
  return out;
}

class Sender {
 public:
  Sender() : socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    const in_addr loopback{htonl(INADDR_LOOPBACK)};
    setsockopt(socket_, IPPROTO_IP, IP_MULTICAST_IF, &loopback, sizeof loopback);
  }
  ~Sender() { ::close(socket_); }
  Sender(const Sender&) = delete;
  Sender& operator=(const Sender&) = delete;

  void SendTo(const char* host, int port, const Datagram& datagram) const {
    const sockaddr_in to = AddressOf(host, port);
    ::sendto(socket_, datagram.data(), datagram.size(), 0, reinterpret_cast<const sockaddr*>(&to),
             sizeof to);
  }

 private:
  int socket_;
};

// An announcement of a running participant, as it is sent to the group.
Datagram HeardAnnouncement() {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int yes = 1;
  setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const sockaddr_in group = AddressOf(kDiscoveryGroup, kDiscoveryPort);
  ::bind(socket, reinterpret_cast<const sockaddr*>(&group), sizeof group);
  const ip_mreq membership{group.sin_addr, {htonl(INADDR_LOOPBACK)}};
  setsockopt(socket, IPPROTO_IP, IP_ADD_MEMBERSHIP, &membership, sizeof membership);
  Datagram out(65536);
  pollfd wait{socket, POLLIN, 0};
  const ssize_t size = ::poll(&wait, 1, 10000) == 1 ? ::recv(socket, out.data(), out.size(), 0) : 0;
  ::close(socket);
  out.resize(static_cast<std::size_t>(std::max<ssize_t>(0, size)));
  return out;
}

class HostileDatagrams : public ::testing::Test {
 protected:
  explicit HostileDatagrams(const std::filesystem::path& key = {})
      : provider_(InRealTime("provider", key)),
        controller_(InRealTime("controller", key)),
        writer_(controller_.MakeWriter(kJointCommand)),
        reader_(provider_.MakeReader(kJointCommand)) {}

  // A command of the controller reaches the provider.
  bool StillTalk() {
    const auto end = std::chrono::steady_clock::now() + 10s;
    msg::JointCommand command;
    command.header.tick = ++tick_;
    while (std::chrono::steady_clock::now() < end) {
      if (writer_.Write(command) == WriteStatus::kFailed) return false;
      while (const auto heard = reader_.WaitNext(20ms)) {
        if (heard->header.tick == tick_) return true;
      }
    }
    return false;
  }

  // To the group and to every port of both participants.
  void Send(const Datagram& datagram) {
    sender_.SendTo(kDiscoveryGroup, kDiscoveryPort, datagram);
    for (const int port : ports_) sender_.SendTo("127.0.0.1", port, datagram);
  }

  // With some bytes behind the header changed; `between` after every hundredth, for sockets hold
  // some hundreds of them.
  void SendChanged(const Datagram& seed, int count, const std::function<void(int)>& between) {
    std::mt19937 random(7);
    for (int round = 1; round <= count; ++round) {
      Datagram bytes = seed;
      for (unsigned k = 0; k <= random() % 6; ++k) {
        bytes[20 + random() % (bytes.size() - 20)] =
            static_cast<std::uint8_t>(random() % 3 == 0 ? random() % 4 : random());
      }
      Send(bytes);
      if (round % 100 == 0) between(round);
    }
  }

  Node provider_, controller_;
  Writer<msg::JointCommand> writer_;
  Reader<msg::JointCommand> reader_;
  Sender sender_;
  std::uint64_t tick_ = 0;
  std::set<int> ports_ = OpenPorts();
};

TEST_F(HostileDatagrams, StatisticsOfTheLibraryBeforeOtherBytesEndNobody) {
  ASSERT_TRUE(StillTalk());
  Datagram hostile = Header();
  AddSubmessage(&hostile, kStatisticsId, Datagram(56, 0));
  hostile.insert(hostile.end(), {1, 1, 0, 0});
  ASSERT_EQ(hostile.size(), 84u);
  for (int k = 0; k < 20; ++k) Send(hostile);
  EXPECT_TRUE(StillTalk());
}

TEST_F(HostileDatagrams, ASampleOfNoWriterReachesNoReaderAndEndsNobody) {
  ASSERT_TRUE(StillTalk());
  Datagram hostile = Header();
  AddSubmessage(&hostile, kDataId, Data({0, 0, 0, 0}, Datagram(400, 0)), kWithPayload);
  const std::uint64_t before = reader_.received();
  const std::uint64_t dropped = internal::ReceivedDatagrams().dropped;
  for (int k = 0; k < 20; ++k) Send(hostile);
  // Every port reads in a thread of its own.
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (internal::ReceivedDatagrams().dropped < dropped + 20) {
    ASSERT_LT(std::chrono::steady_clock::now(), end);
    ASSERT_TRUE(StillTalk());
  }
  EXPECT_LE(reader_.received(), before + tick_ + 20);
}

// The sender's own prefix, wherever it stands.
Datagram OfAnotherParticipant(Datagram datagram) {
  const Datagram prefix(datagram.begin() + 8, datagram.begin() + 20);
  for (auto at = datagram.begin();
       (at = std::search(at, datagram.end(), prefix.begin(), prefix.end())) != datagram.end();) {
    at = std::fill_n(at, prefix.size(), std::uint8_t{0x5a});
  }
  return datagram;
}

TEST_F(HostileDatagrams, AnnouncementsOfStrangersWithChangedBytesEndNobody) {
  ASSERT_TRUE(StillTalk());
  const Datagram seed = OfAnotherParticipant(HeardAnnouncement());
  ASSERT_GT(seed.size(), 100u);
  const auto began = internal::ReceivedDatagrams();
  SendChanged(seed, 4000, [&](int round) { ASSERT_TRUE(StillTalk()) << round; });
  const auto ended = internal::ReceivedDatagrams();
  EXPECT_GT(ended.received - began.received, 4000u);
  EXPECT_GT(ended.dropped, began.dropped);
  EXPECT_LT(ended.dropped - began.dropped, ended.received - began.received);
}

// Without keys who speaks in the name of a participant is accepted, so that it may be lost to the
// others (docs/safety.md). It lives on, and newcomers find each other.
TEST_F(HostileDatagrams, AnnouncementsInTheNameOfAParticipantEndNobody) {
  ASSERT_TRUE(StillTalk());
  const Datagram seed = HeardAnnouncement();
  ASSERT_GT(seed.size(), 100u);
  SendChanged(seed, 4000, [](int) {});
  Node newcomer(InRealTime("newcomer")), listener(InRealTime("listener"));
  auto writer = newcomer.MakeWriter(kJointCommand);
  auto reader = listener.MakeReader(kJointCommand);
  const auto end = std::chrono::steady_clock::now() + 10s;
  bool heard = false;
  while (!heard && std::chrono::steady_clock::now() < end) {
    ASSERT_NE(writer.Write(msg::JointCommand()), WriteStatus::kFailed);
    heard = reader.WaitNext(20ms).has_value();
  }
  EXPECT_TRUE(heard);
}

struct KeyFile {
  explicit KeyFile(char digit) : path(folder.Write("robot.key", std::string(64, digit))) {
    ::chmod(path.c_str(), 0600);
  }
  sinew::testing::TemporaryFolder folder;
  std::filesystem::path path;
};

// The file is there before the participants are.
class HostileDatagramsWithAKey : protected KeyFile, public HostileDatagrams {
 protected:
  HostileDatagramsWithAKey() : KeyFile('a'), HostileDatagrams(path) {}

  // Everything that was sent since has been dropped.
  void AwaitDropped(std::uint64_t since, std::uint64_t count) {
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (internal::ReceivedDatagrams().dropped < since + count) {
      ASSERT_LT(std::chrono::steady_clock::now(), end);
      ASSERT_TRUE(StillTalk());
    }
  }
};

TEST_F(HostileDatagramsWithAKey, WellFormedOnesOfStrangersAreDropped) {
  ASSERT_TRUE(StillTalk());
  Datagram tagged = HeardAnnouncement();
  ASSERT_TRUE(internal::DatagramKey::HasTag(tagged));
  const Datagram plain(tagged.begin(), tagged.end() - internal::DatagramKey::kTagBytes);
  tagged.back() ^= 1;
  for (const Datagram& datagram : {plain, OfAnotherParticipant(plain), tagged}) {
    const std::uint64_t dropped = internal::ReceivedDatagrams().dropped;
    for (int k = 0; k < 20; ++k) Send(datagram);
    AwaitDropped(dropped, 20 * ports_.size());
  }
}

TEST_F(HostileDatagramsWithAKey, WhoLacksTheKeyNeitherHearsNorIsHeard) {
  const KeyFile another('b'), third('c');
  Node deaf(InRealTime("deaf")), deaf_too(InRealTime("deaf_too", another.path));
  Node mute(InRealTime("mute")), mute_too(InRealTime("mute_too", third.path));
  auto unheard = deaf.MakeReader(kJointCommand), unheard_too = deaf_too.MakeReader(kJointCommand);
  auto writer = mute.MakeWriter(kJointCommand), writer_too = mute_too.MakeWriter(kJointCommand);
  ASSERT_TRUE(StillTalk());
  const std::uint64_t before = reader_.received() - tick_;
  // A newcomer with the key is found meanwhile, by the same announcements.
  Node newcomer(InRealTime("newcomer", path));
  auto heard = newcomer.MakeReader(kJointCommand);
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (heard.received() < 20) {
    ASSERT_LT(std::chrono::steady_clock::now(), end);
    ASSERT_TRUE(StillTalk());
    ASSERT_NE(writer.Write(msg::JointCommand()), WriteStatus::kFailed);
    ASSERT_NE(writer_too.Write(msg::JointCommand()), WriteStatus::kFailed);
  }
  EXPECT_EQ(unheard_too.received(), 0u);
  // The one without any key hears the mute without one, and nobody else.
  EXPECT_LE(unheard.received(), tick_);
  EXPECT_LE(reader_.received(), before + tick_);
}

}  // namespace
}  // namespace sinew::node

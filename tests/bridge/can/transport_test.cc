// Transports without hardware: the bus between processes (here between threads), the bus in memory,
// a log. SocketCAN itself is tested on a real kernel, tests/kernel.
#include "bridge/can/transport/transport.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <utility>

#include "bridge/can/bit_timing.h"
#include "bridge/can/codec.h"
#include "bridge/can/transport/bus_master.h"
#include "bridge/can/transport/bus_protocol.h"
#include "bridge/can/transport/bus_server.h"
#include "bridge/can/transport/replay_can.h"
#include "bridge/can/transport/socketcan.h"
#include "bridge/can/transport/virtual_can.h"
#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "tests/support/memory_can.h"
#include "tests/support/skip.h"
#include "tests/support/strange_socket.h"

namespace sinew::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

Frame Data(std::uint32_t id, std::initializer_list<int> bytes) {
  Frame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

std::string Path(const std::string& name) {
  return (std::filesystem::temp_directory_path() /
          ("sinew-test-" + std::to_string(::getpid()) + "-" + name))
      .string();
}

// A server in a thread of its own.
class RunningBus {
 public:
  explicit RunningBus(const std::string& path, const BusConfig& config = {})
      : server_(path, config), thread_([this] {
          while (!stop_) server_.RunOnce(milliseconds(5));
        }) {}
  ~RunningBus() {
    stop_ = true;
    thread_.join();
  }

 private:
  BusServer server_;
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

TEST(VirtualCan, FrameArrivesAtAllOthersAndNotAtItsSender) {
  const std::string path = Path("all");
  const RunningBus bus(path);
  VirtualCan a({path}), b({path}), c({path});
  const Frame frame = Data(0x123, {1, 2, 3});
  Received received;
  ASSERT_EQ(a.Send(frame), SendStatus::kOk);
  ASSERT_TRUE(b.Receive(seconds(5), &received));
  EXPECT_EQ(received.frame, frame);
  ASSERT_TRUE(c.Receive(seconds(5), &received));
  EXPECT_EQ(received.frame, frame);
  EXPECT_LE(received.stamp_ns, c.now_ns());
  EXPECT_GT(received.stamp_ns, c.now_ns() - 5'000'000'000);
  EXPECT_FALSE(a.Receive(milliseconds(0), &received));
  EXPECT_EQ(c.bitrate_bit_s(), 1e6);
  EXPECT_EQ(c.counters().received, a.counters().sent);
  EXPECT_EQ(c.counters().wire_bits, a.counters().wire_bits);
}

TEST(VirtualCan, FiltersLetOnlyTheWantedIdentifiersThrough) {
  const std::string path = Path("filter");
  const RunningBus bus(path);
  VirtualCan a({path});
  VirtualCan b({path, {{0x60, 0x7E0, false}}});  // node 3
  Received received;
  ASSERT_EQ(a.Send(Encode(4, Heartbeat{})), SendStatus::kOk);
  ASSERT_EQ(a.Send(Encode(3, Iq{1, 2})), SendStatus::kOk);
  ASSERT_TRUE(b.Receive(seconds(5), &received));
  EXPECT_EQ(received.frame, Encode(3, Iq{1, 2}));
}

TEST(VirtualCan, FramesKeepTheirDistanceInBitTimes) {
  const std::string path = Path("timing");
  const RunningBus bus(path, {.bitrate_bit_s = 125e3});
  VirtualCan a({path}), b({path});
  Received received;
  const Frame frame = Data(0x100, {1, 2, 3, 4, 5, 6, 7, 8});
  for (int i = 0; i < 10; ++i) ASSERT_EQ(a.Send(frame), SendStatus::kOk);
  std::int64_t last = 0;
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(b.Receive(seconds(5), &received));
    if (i > 0) {
      // Never closer than the wire allows; the server received all ten within one frame's 0.9 ms
      // or not.
      EXPECT_GE(received.stamp_ns - last, 8000 * FrameBits(frame));
    }
    last = received.stamp_ns;
  }
}

TEST(VirtualCan, FullQueueIsReportedAndCountedAsDropped) {
  const std::string path = Path("full");
  const RunningBus bus(path, {.bitrate_bit_s = 10e3, .queue_frames = 2});
  VirtualCan a({path});
  for (int i = 0; i < 50; ++i)
    ASSERT_EQ(a.Send(Data(0x1, {1, 2, 3, 4, 5, 6, 7, 8})), SendStatus::kOk);
  Received received;
  const auto give_up = types::MonotonicNow_ns() + 10'000'000'000;
  while (a.counters().dropped < 40 && types::MonotonicNow_ns() < give_up)
    (void)a.Receive(milliseconds(10), &received);
  EXPECT_GE(a.counters().dropped, 40U);
  EXPECT_EQ(a.counters().sent + a.counters().dropped, 50U);
}

TEST(VirtualCan, TwoNodesWithOneIdentifierEndInBusOffAndComeBack) {
  const std::string path = Path("collision");
  const RunningBus bus(path, {.queue_frames = 4, .restart_ns = 20'000'000});
  VirtualCan a({path}), b({path});
  Received received;
  bool seen = false;
  const auto give_up = types::MonotonicNow_ns() + 20'000'000'000;
  for (int i = 0; !seen && types::MonotonicNow_ns() < give_up; ++i) {
    // Neither knows of the other; as soon as both are offered while the bus is busy they collide.
    (void)a.Send(Data(0x1, {1}));
    (void)b.Send(Data(0x1, {2}));
    (void)a.Receive(milliseconds(1), &received);
    (void)b.Receive(milliseconds(1), &received);
    seen = a.link() == Link::kBusOff;
  }
  ASSERT_TRUE(seen);
  EXPECT_EQ(a.Send(Data(0x1, {1})), SendStatus::kDown);
  EXPECT_GE(a.counters().error_frames, 32U);
  while (a.link() == Link::kBusOff && types::MonotonicNow_ns() < give_up)
    (void)a.Receive(milliseconds(5), &received);
  EXPECT_EQ(a.link(), Link::kUp);
}

TEST(VirtualCan, MissingBusIsAUsageErrorThatNamesIt) {
  try {
    VirtualCan a({Path("nobody"), {}, milliseconds(10)});
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("nobody"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("sinew-can-bus --bus"), std::string::npos)
        << error.what();
  }
}

TEST(VirtualCan, NodeJoinsAgainWhenTheBusWasRestarted) {
  const std::string path = Path("restart");
  auto bus = std::make_unique<RunningBus>(path);
  VirtualCan a({path}), b({path});
  bus.reset();
  Received received;
  EXPECT_FALSE(a.Receive(milliseconds(1), &received));
  EXPECT_EQ(a.link(), Link::kDown);
  EXPECT_EQ(a.Send(Data(1, {})), SendStatus::kDown);
  bus = std::make_unique<RunningBus>(path);
  bool arrived = false;
  for (int i = 0; i < 250 && !arrived; ++i) {
    (void)a.Send(Data(0x42, {}));
    arrived = b.Receive(milliseconds(20), &received);
  }
  EXPECT_TRUE(arrived);
  EXPECT_EQ(a.link(), Link::kUp);
}

TEST(BusServer, SecondServerOfOneNameIsRefusedAndALeftOverSocketIsNot) {
  const std::string path = Path("twice");
  {
    const BusServer first(path, {});
    EXPECT_THROW(BusServer(path, {}), UsageError);
  }
  // What a killed server leaves: a socket nobody listens on.
  const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  ::close(socket);
  EXPECT_NO_THROW(BusServer(path, {}));
}

TEST(BusServer, FileInTheWayIsNotRemoved) {
  const std::string path = Path("file");
  std::ofstream(path) << "precious";
  EXPECT_THROW(BusServer(path, {}), UsageError);
  EXPECT_TRUE(std::filesystem::exists(path));
  std::filesystem::remove(path);
}

TEST(VirtualCan, TheBusOfAnotherUserInItsPlaceIsNone) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "second user for this one");
  const std::string path = Path("strange");
  const config::Descriptor stranger = testing::ListenAs(testing::kStranger, path, SOCK_SEQPACKET);
  try {
    const VirtualCan node({.bus = path, .connect_timeout = milliseconds(100)});
    ADD_FAILURE() << "joined";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("user 65534 listens on " + path), std::string::npos)
        << error.what();
  }
  std::filesystem::remove(path);
}

TEST(BusServer, AProcessOfAnotherUserIsNoNode) {
  SKIP_WITHOUT_KERNEL(::geteuid() == 0, "second user for this one");
  const std::string path = Path("guarded");
  BusServer server(path, {});
  std::filesystem::permissions(path, std::filesystem::perms::all);
  const auto address = *config::SocketAddress(path);
  const auto connect = [&](uid_t user) {
    config::Descriptor client(::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0));
    // Of this thread alone, unlike seteuid().
    EXPECT_EQ(::syscall(SYS_setresuid, -1, user, -1), 0);
    EXPECT_EQ(::connect(client.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
              0);
    EXPECT_EQ(::syscall(SYS_setresuid, -1, 0, -1), 0);
    server.RunOnce(seconds(5));
    return client;
  };
  const config::Descriptor stranger = connect(testing::kStranger);
  EXPECT_EQ(server.clients(), 0);
  const config::Descriptor own = connect(0);
  EXPECT_EQ(server.clients(), 1);
}

TEST(BusServer, GarbageFromAClientIsIgnored) {
  const std::string path = Path("garbage");
  const RunningBus bus(path);
  VirtualCan a({path}), b({path});
  const int socket = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  ASSERT_EQ(::connect(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  Packet packet;
  packet.kind = PacketKind::kFrame;
  packet.id = 0xFFFFFFFF;
  packet.length = 200;
  for (std::size_t size = 1; size <= sizeof packet; ++size)
    ::send(socket, &packet, size, MSG_NOSIGNAL);
  ::close(socket);
  bool arrived = false;
  Received received;
  for (int i = 0; i < 250 && !arrived; ++i) {
    (void)a.Send(Data(0x42, {7}));
    arrived = b.Receive(milliseconds(20), &received);
  }
  ASSERT_TRUE(arrived);
  EXPECT_EQ(received.frame, Data(0x42, {7}));
}

TEST(MemoryCan, TimePassesOnlyWhereSomebodyWaits) {
  MemoryBus bus({});
  const auto a = bus.Join("a"), b = bus.Join("b");
  const Frame frame = Data(0x10, {1});
  ASSERT_EQ(a->Send(frame), SendStatus::kOk);
  Received received;
  EXPECT_FALSE(b->Receive(milliseconds(0), &received));
  EXPECT_EQ(bus.now_ns(), 0);
  ASSERT_TRUE(b->Receive(milliseconds(1), &received));
  EXPECT_EQ(received.frame, frame);
  EXPECT_EQ(received.stamp_ns, 1000 * FrameBits(frame));
  EXPECT_EQ(bus.now_ns(), received.stamp_ns);
  EXPECT_FALSE(b->Receive(milliseconds(1), &received));
  EXPECT_EQ(bus.now_ns(), 1000 * FrameBits(frame) + 1'000'000);
}

TEST(MemoryCan, AgentsRunAtTheirTimes) {
  MemoryBus bus({});
  const auto a = bus.Join("a");
  std::vector<std::int64_t> times;
  std::int64_t next = 500;
  bus.AddAgent([&] { return next; },
               [&](std::int64_t now) {
                 times.push_back(now);
                 next += 1000;
               });
  bus.AdvanceTo(2600);
  EXPECT_EQ(times, (std::vector<std::int64_t>{500, 1500, 2500}));
}

TEST(ReplayCan, FramesOfALogComeInOrderAndAtTheirDistance) {
  std::vector<LogLine> lines;
  for (int i = 0; i < 5; ++i)
    lines.push_back({1'000'000'000 + i * 2'000'000, "can0", Data(0x10 + i, {i})});
  lines.push_back({0, "can1", Data(0x99, {})});
  ReplayCan replay("log", lines, "can0");
  Received received;
  std::int64_t first = 0;
  for (int i = 0; i < 5; ++i) {
    ASSERT_TRUE(replay.Receive(seconds(5), &received));
    EXPECT_EQ(received.frame, lines[static_cast<std::size_t>(i)].frame);
    if (i == 0) first = received.stamp_ns;
    EXPECT_EQ(received.stamp_ns - first, i * 2'000'000);
  }
  EXPECT_FALSE(replay.Receive(milliseconds(0), &received));
  EXPECT_EQ(replay.link(), Link::kDown);
  EXPECT_EQ(replay.Send(Data(1, {})), SendStatus::kDown);
}

TEST(ReplayCan, BrokenLineIsNamedWithFileAndNumber) {
  const std::string path = Path("broken.log");
  std::ofstream(path) << "(1436509052.249713) can0 044#2A\nnonsense\n";
  try {
    ReadCandumpFile(path);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(path + ":2:"), std::string::npos) << error.what();
  }
  std::ofstream(path) << "(1436509052.249713) can0 45123#81:00:12345678#11223344\n";
  try {
    ReadCandumpFile(path);
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(error.what(), path +
                                ":1: a frame of CAN XL, which is not read, expected classic CAN "
                                "or CAN FD");
  }
  std::filesystem::remove(path);
}

TEST(SocketCan, AbsentInterfaceIsAUsageErrorInOneLine) {
  for (const std::string name : {"can97", "", "a_name_that_is_too_long"}) {
    try {
      SocketCan can({name, {}, 0});
      FAIL() << name;
    } catch (const UsageError& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

std::string RefusalOf(const std::string& bus) {
  try {
    const BusMaster second(bus);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(BusMaster, IsOneProcessAndTheSecondLearnsWhich) {
  const std::string bus = Path("commanded"), other = Path("other");
  {
    const BusMaster first(bus);
    const std::string refusal = RefusalOf(bus);
    EXPECT_NE(refusal.find("process " + std::to_string(::getpid())), std::string::npos) << refusal;
    EXPECT_EQ(RefusalOf(other), "");
  }
  EXPECT_EQ(RefusalOf(bus), "") << "it ended with its holder";
}

TEST(BusMaster, MayBeMovedAndHaveALongName) {
  const std::string bus(300, 'b');
  BusMaster first(bus);
  const BusMaster moved(std::move(first));
  EXPECT_NE(RefusalOf(bus), "");
}

}  // namespace
}  // namespace sinew::can

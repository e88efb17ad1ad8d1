// Who on a network can reach a robot: nobody, unless its processes were given an interface.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "tests/support/program.h"
#include "tests/support/skip.h"
#include "tests/support/test_host.h"

namespace sinew::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

namespace fs = std::filesystem;

const std::string kBin = SINEW_BIN_DIR;
const std::string kSurrogateConfig = SINEW_SOURCE_DIR "/robots/rig/surrogate.yaml";
constexpr auto kEnough = 30s;
constexpr char kRuns[] = "real time,";  // in the surrogate's line of start

std::string Ask(const std::string& what) { return kBin + "/sinew " + what; }

std::vector<std::string> Words(const std::string& line) {
  std::istringstream in(line);
  return {std::istream_iterator<std::string>(in), std::istream_iterator<std::string>()};
}

std::vector<std::string> Surrogate(const std::string& domain) {
  return {kBin + "/sinew-surrogate", "--config", kSurrogateConfig, "--domain", domain};
}

// "0100007F:1CE8" -> "127.0.0.1"; little-endian, as this machine's kernel prints it.
std::string AddressOf(const std::string& hex) {
  const auto value = static_cast<std::uint32_t>(std::stoul(hex.substr(0, 8), nullptr, 16));
  std::string text;
  for (int byte = 0; byte < 4; ++byte) {
    text += (byte == 0 ? "" : ".") + std::to_string((value >> (8 * byte)) & 0xFF);
  }
  return text;
}

// Local addresses of the UDP and TCP sockets that a process has open.
std::set<std::string> AddressesOfSockets(pid_t pid) {
  const fs::path process = "/proc/" + std::to_string(pid);
  std::set<std::string> inodes;
  for (const auto& entry : fs::directory_iterator(process / "fd")) {
    std::error_code error;
    const std::string target = fs::read_symlink(entry.path(), error).string();
    if (target.rfind("socket:[", 0) == 0) inodes.insert(target.substr(8, target.size() - 9));
  }
  std::set<std::string> addresses;
  for (const char* table : {"udp", "tcp", "udp6", "tcp6"}) {
    std::ifstream in(process / "net" / table);
    std::string line;
    std::getline(in, line);  // headings
    while (std::getline(in, line)) {
      const std::vector<std::string> words = Words(line);
      if (words.size() < 10 || !inodes.contains(words[9])) continue;
      addresses.insert(table[3] == '6' ? "IPv6 " + words[1] : AddressOf(words[1]));
    }
  }
  return addresses;
}

// Multicast groups that were joined on an interface, of everything in the process' namespace.
std::set<std::string> GroupsJoinedOn(const std::string& interface, pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/net/igmp");
  std::set<std::string> groups;
  std::string line, current;
  while (std::getline(in, line)) {
    const std::vector<std::string> words = Words(line);
    if (words.size() >= 2 && line[0] != '\t') current = words[1];
    if (line[0] == '\t' && current == interface) groups.insert(AddressOf(words[0]));
  }
  return groups;
}

std::uint64_t PacketsSentOn(const std::string& interface, pid_t pid) {
  std::ifstream in("/proc/" + std::to_string(pid) + "/net/dev");
  for (std::string line; std::getline(in, line);) {
    const std::vector<std::string> words = Words(line);
    if (words.size() > 10 && words[0] == interface + ":") return std::stoull(words[10]);
  }
  throw std::runtime_error("no " + interface);
}

// The program itself: `nsenter` becomes it by exec.
pid_t PidOf(const Program& program) { return program.pid(); }

constexpr char kGroup[] = "239.255.0.1";  // of discovery

TEST(Network, SocketsAreBoundToLoopbackUnlessAnInterfaceIsNamed) {
  Program surrogate(Surrogate("54"));
  ASSERT_TRUE(surrogate.WaitForText(kRuns, kEnough)) << surrogate.error();
  // It answers, so all its sockets are there.
  ASSERT_EQ(testing::Run(Words(Ask("estop --domain 54"))).exit_code, 0) << surrogate.error();
  const std::set<std::string> addresses = AddressesOfSockets(PidOf(surrogate));
  EXPECT_THAT(addresses, Contains("127.0.0.1"));
  for (const std::string& address : addresses) {
    EXPECT_TRUE(address == "127.0.0.1" || address == kGroup) << address;
  }
  EXPECT_THAT(surrogate.error(), Not(HasSubstr("open to the network")));
}

TEST(Network, AnInterfaceThatDoesNotExistIsRefused) {
  std::vector<std::string> line = Surrogate("54");
  line.insert(line.end(), {"--interface", "nowhere0"});
  const Finished surrogate = testing::Run(line);
  EXPECT_EQ(surrogate.exit_code, 2);
  EXPECT_THAT(surrogate.error, AllOf(HasSubstr("--interface nowhere0"),
                                     HasSubstr("expected one of lo (127.0.0.1)")));
}

TEST(Network, NobodyOnItReachesARobotThatNamesNoInterface) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  Program surrogate(hosts.On(0, Surrogate("55")));
  ASSERT_TRUE(surrogate.WaitForText(kRuns, kEnough)) << surrogate.error();
  // The robot's own host, whose loopback has neither a multicast flag nor a route.
  const Finished own = testing::Run(hosts.On(0, Words(Ask("estop --domain 55"))));
  ASSERT_EQ(own.exit_code, 0) << own.error << surrogate.error();
  // A recorder beside it that was opened to the network, as for a screen elsewhere: it hears the
  // other host, and the robot does not.
  Program echo(hosts.On(0, Words(Ask("echo joint_state --domain 55 --interface wire0"))));
  ASSERT_TRUE(echo.WaitForText("robot_state", kEnough)) << echo.error();
  for (const char* command : {"reset", "disarm"}) {
    const Finished other = testing::Run(hosts.On(
        1, Words(Ask(std::string(command) + " --domain 55 --interface wire0 --timeout 2"))));
    EXPECT_EQ(other.exit_code, 1) << command << other.output;
  }
  EXPECT_EQ(echo.Wait(0ms), Program::kTimeout) << "it still runs";
  const Finished still = testing::Run(hosts.On(0, Words(Ask("arm --domain 55 --timeout 2"))));
  EXPECT_EQ(still.exit_code, 1) << "the reset came through";
}

TEST(Network, NothingLeavesAHostThatNamesNoInterface) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  Program surrogate(hosts.On(0, Surrogate("56")));
  ASSERT_TRUE(surrogate.WaitForText(kRuns, kEnough)) << surrogate.error();
  ASSERT_EQ(testing::Run(hosts.On(0, Words(Ask("estop --domain 56")))).exit_code, 0)
      << surrogate.error();
  EXPECT_EQ(PacketsSentOn("wire0", PidOf(surrogate)), 0u);
  EXPECT_THAT(GroupsJoinedOn("lo", PidOf(surrogate)), Contains(kGroup));
  EXPECT_THAT(GroupsJoinedOn("wire0", PidOf(surrogate)), Not(Contains(kGroup)));
}

TEST(Network, ANamedInterfaceIsOpenAndItsRiskIsSaid) {
  const TwoHosts hosts;
  SKIP_WITHOUT_KERNEL(hosts.why_not().empty(), hosts.why_not());
  std::vector<std::string> line = Surrogate("57");
  line.insert(line.end(), {"--interface", "wire0"});
  Program surrogate(hosts.On(0, line));
  EXPECT_TRUE(surrogate.WaitForText(
      "open to the network on wire0 (" + TwoHosts::Address(0) + ") without a key or DDS security",
      kEnough))
      << surrogate.error();
  const Finished other =
      testing::Run(hosts.On(1, Words(Ask("estop --domain 57 --interface wire0"))));
  EXPECT_EQ(other.exit_code, 0) << other.error << surrogate.error();
  EXPECT_THAT(AddressesOfSockets(PidOf(surrogate)), Contains(TwoHosts::Address(0)));
  EXPECT_THAT(GroupsJoinedOn("wire0", PidOf(surrogate)), Contains(kGroup));
  // Commands of its own host reach it without naming the interface.
  const Finished own = testing::Run(hosts.On(0, Words(Ask("reset --domain 57"))));
  EXPECT_EQ(own.exit_code, 0) << own.error << surrogate.error();
}

}  // namespace
}  // namespace sinew::testing

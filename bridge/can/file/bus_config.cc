#include "bridge/can/file/bus_config.h"

#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>

#include "bridge/can/transport/replay_can.h"
#include "bridge/can/transport/socketcan.h"
#include "bridge/can/transport/virtual_can.h"
#include "components/base/config/descriptor.h"
#include "components/base/types/angle.h"

namespace sinew::can {
namespace {

// Driver of a network interface; empty: the kernel does not say.
std::string DriverOf(const std::string& interface) {
  const config::Descriptor socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  ifreq request{};
  interface.copy(request.ifr_name, sizeof request.ifr_name - 1);
  request.ifr_data = reinterpret_cast<char*>(&info);
  const bool known = socket.get() >= 0 && ::ioctl(socket.get(), SIOCETHTOOL, &request) == 0;
  info.driver[sizeof info.driver - 1] = '\0';
  return known ? info.driver : "";
}

}  // namespace

static void Describe(config::Fields& f, BusEntry& c) {
  f.Need("name", c.name, "for the joints");
  const auto transport = f.NeedWord("transport", c.kind,
                                    {{"socketcan", TransportKind::kSocketCan},
                                     {"virtual", TransportKind::kVirtual},
                                     {"replay", TransportKind::kReplay}},
                                    "an interface, a sinew-can-bus, or a log");
  if (const auto socketcan = transport.Is({"socketcan"})) {
    f.Need("interface", c.interface, "such as can0");
  }
  if (const auto joined = transport.Is({"virtual"})) {
    if (f.reads()) c.bus = c.name;
    f("bus", c.bus, "the sinew-can-bus to join, name or path of its socket; left out: the name");
    f("connect_timeout_ms", c.connect_timeout_ms, {0, 600000}, "until the bus appears");
  }
  if (const auto replay = transport.Is({"replay"})) {
    std::filesystem::path file;
    f.Need("file", file, "a log of candump -l");
    c.file = file.string();
    f("interface", c.interface, "such as can0");
  }
  f("bitrate_bit_s", c.bitrate_bit_s, {1e4, 1e6},
    "for the load; the interface itself is set by ip link");
}

void DescribeBuses(config::Fields& f, std::vector<BusEntry>* buses) {
  f.NeedList("buses", {1}, "of the robot", [buses](config::Fields& g) {
    BusEntry entry;
    Describe(g, entry);
    const bool known = std::any_of(buses->begin(), buses->end(),
                                   [&](const BusEntry& b) { return b.name == entry.name; });
    g.Require(!known, "name", "'" + entry.name + "' is used twice, expected a name of its own");
    buses->push_back(entry);
  });
}

void DescribeAddress(config::Fields& f, const std::vector<BusEntry>& buses, int* bus, int* node) {
  std::string name;
  if (!f.reads()) f("bus", name, "by its name; with one bus it may be left out");
  if (f.reads() && (buses.size() > 1 || f.section().Has("bus"))) {
    std::vector<std::string> names;
    names.reserve(buses.size());
    for (const BusEntry& entry : buses) names.push_back(entry.name);
    name = f.section().Choice("bus", names);
    *bus = static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  f.Need("node", *node, {0, kMaxNode}, "on the bus");
}

std::unique_ptr<Transport> OpenBus(const BusEntry& entry, const std::vector<IdFilter>& filters) {
  switch (entry.kind) {
    case TransportKind::kSocketCan:
      return std::make_unique<SocketCan>(SocketCanOptions{entry.interface, filters, 0});
    case TransportKind::kReplay:
      return std::make_unique<ReplayCan>(entry.name, ReadCandumpFile(entry.file), entry.interface,
                                         filters);
    case TransportKind::kVirtual:
      break;
  }
  return std::make_unique<VirtualCan>(
      VirtualCanOptions{entry.bus, filters, std::chrono::milliseconds(entry.connect_timeout_ms)});
}

std::optional<BusMaster> CommandBus(const BusEntry& entry) {
  switch (entry.kind) {
    case TransportKind::kSocketCan:
      return BusMaster(entry.interface);
    case TransportKind::kVirtual:
      return BusMaster(BusSocketPath(entry.bus));
    case TransportKind::kReplay:
      break;
  }
  return std::nullopt;
}

bool IsHardware(const BusEntry& entry) {
  if (entry.kind != TransportKind::kSocketCan) return false;
  const std::string folder = "/sys/class/net/" + entry.interface;
  std::error_code ignored;  // an interface that is not there is reported by OpenBus
  if (!std::filesystem::exists(folder, ignored)) return false;
  const std::string driver = DriverOf(entry.interface);
  if (!driver.empty()) return driver != "vcan" && driver != "vxcan";
  // A kernel before 5.16 does not name these; an adapter at a serial port (slcan) has a driver.
  return std::filesystem::exists(folder + "/device", ignored);
}

const char* FirmwareName(Firmware firmware) {
  switch (firmware) {
    case Firmware::k0_5_1:
      return "0.5.1";
    case Firmware::k0_5_4:
      return "0.5.4";
    case Firmware::k0_5_6:
      break;
  }
  return "0.5.6";
}

void DescribeFirmware(config::Fields& f, Firmware& firmware) {
  f.Word("firmware", firmware,
         {{"0.5.1", Firmware::k0_5_1}, {"0.5.4", Firmware::k0_5_4}, {"0.5.6", Firmware::k0_5_6}},
         "of the controller");
}

void DescribeDirection(config::Fields& f, int& direction) {
  f("direction", direction, {-1, 1}, "1, or -1: the joint turns the other way");
  if (direction == 0) f.Fail("direction", "is 0, expected 1 or -1");
}

void DescribeBodyPart(config::Fields& f, BodyPart& part, std::array<double, 3>& mounting_rpy_rad,
                      const config::Fields::Body& more) {
  const auto sensor = f.NeedWord("sensor", part,
                                 {{"right_foot", BodyPart::kRightFoot},
                                  {"left_foot", BodyPart::kLeftFoot},
                                  {"imu", BodyPart::kImu}},
                                 "what the node measures");
  const auto imu = sensor.Is({"imu"});
  if (!imu) return;
  f("mounting_rpy_rad", mounting_rpy_rad, {-types::kTwoPi, types::kTwoPi}, "roll, pitch, yaw");
  if (more) more(f);
}

}  // namespace sinew::can

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
#include "components/base/types/angle.h"

namespace sinew::can {
namespace {

// Driver of a network interface; empty: the kernel does not say.
std::string DriverOf(const std::string& interface) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  ethtool_drvinfo info{};
  info.cmd = ETHTOOL_GDRVINFO;
  ifreq request{};
  interface.copy(request.ifr_name, sizeof request.ifr_name - 1);
  request.ifr_data = reinterpret_cast<char*>(&info);
  const bool known = socket >= 0 && ::ioctl(socket, SIOCETHTOOL, &request) == 0;
  if (socket >= 0) ::close(socket);
  info.driver[sizeof info.driver - 1] = '\0';
  return known ? info.driver : "";
}

}  // namespace

std::vector<BusEntry> ReadBuses(const config::Section& section) {
  std::vector<BusEntry> buses;
  for (const config::Section& item : section.List("buses")) {
    BusEntry entry;
    entry.name = item.Text("name");
    const std::string kind = item.Choice("transport", {"socketcan", "virtual", "replay"});
    if (kind == "socketcan") {
      entry.kind = TransportKind::kSocketCan;
      entry.interface = item.Text("interface");
    } else if (kind == "virtual") {
      entry.kind = TransportKind::kVirtual;
      entry.bus = item.TextOr("bus", entry.name);
      entry.connect_timeout_ms = static_cast<int>(
          item.IntegerOr("connect_timeout_ms", entry.connect_timeout_ms, {0, 600000}));
    } else {
      entry.kind = TransportKind::kReplay;
      entry.file = item.ExistingPath("file").string();
      entry.interface = item.TextOr("interface", "");
    }
    entry.bitrate_bit_s = item.NumberOr("bitrate_bit_s", 1e6, {1e4, 1e6});
    if (std::any_of(buses.begin(), buses.end(),
                    [&](const BusEntry& b) { return b.name == entry.name; })) {
      item.Fail("name", "'" + entry.name + "' is used twice, expected a name of its own");
    }
    item.RejectUnknownKeys();
    buses.push_back(entry);
  }
  if (buses.empty()) section.Fail("buses", "is empty, expected at least one bus");
  return buses;
}

int ReadBusOf(const config::Section& section, const std::vector<BusEntry>& buses) {
  if (buses.size() == 1 && !section.Has("bus")) return 0;
  std::vector<std::string> names;
  names.reserve(buses.size());
  for (const BusEntry& entry : buses) names.push_back(entry.name);
  const std::string name = section.Choice("bus", names);
  return static_cast<int>(std::find(names.begin(), names.end(), name) - names.begin());
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

Firmware ReadFirmware(const config::Section& section) {
  const std::string text = section.ChoiceOr("firmware", "0.5.6", {"0.5.1", "0.5.4", "0.5.6"});
  return text == "0.5.1" ? Firmware::k0_5_1 : text == "0.5.4" ? Firmware::k0_5_4 : Firmware::k0_5_6;
}

BodyPart ReadBodyPart(const config::Section& section) {
  const std::string text = section.Choice("sensor", {"right_foot", "left_foot", "imu"});
  if (text == "imu") return BodyPart::kImu;
  return text == "right_foot" ? BodyPart::kRightFoot : BodyPart::kLeftFoot;
}

std::array<double, 3> ReadMounting(const config::Section& section) {
  const std::vector<double> angles =
      section.NumbersOr("mounting_rpy_rad", {0.0, 0.0, 0.0}, {-types::kTwoPi, types::kTwoPi});
  if (angles.size() != 3) {
    section.Fail("mounting_rpy_rad",
                 "has " + std::to_string(angles.size()) + " numbers, expected 3: roll, pitch, yaw");
  }
  return {angles[0], angles[1], angles[2]};
}

}  // namespace sinew::can

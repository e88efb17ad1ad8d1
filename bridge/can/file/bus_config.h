// The `buses:` list of a configuration file, and opening what it names. Not for loops.
//
//   buses:
//     - name: legs
//       transport: socketcan     # or virtual, replay
//       interface: can0          # socketcan; replay: only this one's lines
//       bus: legs                # virtual: the sinew-can-bus to join, name or path of its socket
//       file: run.log            # replay: a log of candump -l
//       bitrate_bit_s: 1000000   # for the load; the interface itself is set by ip link
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bridge/can/body_node.h"
#include "bridge/can/codec.h"
#include "bridge/can/transport/bus_master.h"
#include "bridge/can/transport/transport.h"
#include "components/base/config/config.h"

namespace sinew::can {

enum class TransportKind { kSocketCan, kVirtual, kReplay };

struct BusEntry {
  std::string name;
  TransportKind kind = TransportKind::kVirtual;
  std::string interface;
  std::string bus;
  std::string file;
  double bitrate_bit_s = 1e6;
  int connect_timeout_ms = 5000;  // virtual: how long to wait for the bus to appear
};

// Reads section's `buses`; at least one, names unique. Throws UsageError.
std::vector<BusEntry> ReadBuses(const config::Section& section);

// Index of the bus a section's key `bus` names; with one bus the key may be left out.
int ReadBusOf(const config::Section& section, const std::vector<BusEntry>& buses);

// Throws UsageError when it cannot be opened.
std::unique_ptr<Transport> OpenBus(const BusEntry& entry, const std::vector<IdFilter>& filters);

// The right to command it; nobody needs it for a log. Throws UsageError when a process has it.
std::optional<BusMaster> CommandBus(const BusEntry& entry);

// The bus is a CAN controller of this machine, and no interface of software such as vcan.
bool IsHardware(const BusEntry& entry);

// "0.5.6"
const char* FirmwareName(Firmware firmware);
// The key `firmware`: "0.5.1", "0.5.4" or "0.5.6" (the default).
Firmware ReadFirmware(const config::Section& section);
// The key `sensor`: "right_foot", "left_foot" or "imu".
BodyPart ReadBodyPart(const config::Section& section);
// The key `mounting_rpy_rad`: three angles; nothing is no rotation.
std::array<double, 3> ReadMounting(const config::Section& section);

}  // namespace sinew::can

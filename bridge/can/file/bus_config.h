// The `buses:` list of a configuration file, and opening what it names. Not for loops.
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
#include "components/base/config/fields.h"

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

// The key `buses`; at least one, names unique. Throws UsageError.
void DescribeBuses(config::Fields& fields, std::vector<BusEntry>* buses);

// The keys `bus`, whose index this is, and `node`; with one bus the first may be left out.
void DescribeAddress(config::Fields& fields, const std::vector<BusEntry>& buses, int* bus,
                     int* node);

// Throws UsageError when it cannot be opened.
std::unique_ptr<Transport> OpenBus(const BusEntry& entry, const std::vector<IdFilter>& filters);

// The right to command it; nobody needs it for a log. Throws UsageError when a process has it.
std::optional<BusMaster> CommandBus(const BusEntry& entry);

// The bus is a CAN controller of this machine, and no interface of software such as vcan.
bool IsHardware(const BusEntry& entry);

// "0.5.6"
const char* FirmwareName(Firmware firmware);
// The keys `firmware`, `direction`, and `sensor` with, of an IMU, `mounting_rpy_rad` and more.
void DescribeFirmware(config::Fields& fields, Firmware& firmware);
void DescribeDirection(config::Fields& fields, int& direction);
void DescribeBodyPart(config::Fields& fields, BodyPart& part,
                      std::array<double, 3>& mounting_rpy_rad,
                      const config::Fields::Body& more = nullptr);

}  // namespace sinew::can

// Reads the bridge's configuration, schema sinew-can-bridge/1 (docs/participants/can_bridge.md).
// Throws UsageError. Not for loops.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bridge/can/file/bus_config.h"
#include "bridge/joints/can_plant.h"
#include "components/base/config/fields.h"

namespace sinew::bridge {

inline constexpr char kSchema[] = "sinew-can-bridge/1";

struct BridgeFile {
  std::vector<can::BusEntry> buses;
  BridgeConfig bridge;
  std::optional<std::string> watchdog_proof;  // default, none or a path, relative to the file
};

// Keys but `guard` and `estop`, which the program reads.
void Describe(config::Fields& fields, BridgeFile& file);

}  // namespace sinew::bridge

// Reads the bridge's configuration, schema sinew-can-bridge/1 (docs/participants/can_bridge.md).
// Throws UsageError. Not for loops.
#pragma once

#include <string>
#include <vector>

#include "bridge/can/file/bus_config.h"
#include "bridge/joints/can_plant.h"
#include "components/base/config/config.h"

namespace sinew::bridge {

struct BridgeFile {
  std::vector<can::BusEntry> buses;
  BridgeConfig bridge;
};

// Keys `buses`, `origin`, `joints`, `gateways`, `body_nodes`, `timing`, `short_frames`. Other keys
// are the caller's.
BridgeFile ReadBridge(const config::Section& section);

}  // namespace sinew::bridge

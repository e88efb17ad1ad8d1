// Reads the configuration of the virtual axes, schema sinew-virtual-axes/1
// (docs/participants/virtual_axes.md). Throws UsageError. Not for loops.
#pragma once

#include <filesystem>
#include <vector>

#include "bridge/can/file/bus_config.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/base/config/fields.h"

namespace sinew::virtual_axes {

inline constexpr char kSchema[] = "sinew-virtual-axes/1";

struct VirtualAxesFile {
  std::vector<can::BusEntry> buses;
  VirtualAxesConfig axes;
  int joints = 1;                        // of the axes and nodes
  std::filesystem::path surrogate_path;  // empty: the surrogate's defaults
  std::filesystem::path world_path;      // a world instead of the surrogate
};

void Describe(config::Fields& fields, VirtualAxesFile& file);

// Everything on the buses that these nodes are addressed by.
std::vector<can::IdFilter> Filters(const VirtualAxesConfig& config, int bus);

}  // namespace sinew::virtual_axes

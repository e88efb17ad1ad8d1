// State of the CAN interfaces, and which interfaces are tunnels, from what `ip -json -details
// -statistics link show` prints (iproute2). Pure.
#pragma once

#include <string>
#include <vector>

#include "tools/inspect/findings.h"

namespace sinew::inspect {

// Settings that docs/bring-up.md asks for.
struct CanSettings {
  double bitrate_bit_s = 1e6;
  int least_txqueuelen = 128;
};

// A finding for each CAN interface (vcan too), or a note that there is none. Throws
// std::invalid_argument when the text is not what ip prints.
std::vector<Finding> CheckCan(const std::string& ip_json, const CanSettings& settings);

// Names of the interfaces that are WireGuard tunnels, of the same text; none, where it is another.
// The network of this process counts, unlike in /sys, which shows that of whoever mounted it.
std::vector<std::string> WireGuardIn(const std::string& ip_json);

}  // namespace sinew::inspect

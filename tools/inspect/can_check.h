// State of the CAN interfaces, from what `ip -json -details -statistics link show` prints
// (iproute2). Pure.
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

}  // namespace sinew::inspect

// `sinew-can-bridge --prove-watchdogs`: proves axis by axis that its own watchdog idles it, and
// keeps the proofs.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "bridge/joints/file/bridge_config.h"

namespace sinew::bridge {

// Path of the proofs; empty: arming needs none. Throws UsageError: hardware without.
std::filesystem::path ProofPath(const config::Section& section, const BridgeFile& file);

// Why the joints may not be armed; empty: all have a proof, or none is needed.
std::string ArmRefusal(const BridgeConfig& bridge, const std::filesystem::path& proofs,
                       const std::string& config_path);

// One axis after the other, with zero torque; the others are left alone. The file has the proofs of
// those that passed, and none of those that failed. Throws UsageError before anything is armed
// (a joint without serial number, a file that cannot be written), std::runtime_error naming the
// joints that failed.
void ProveWatchdogs(const BridgeFile& file, const std::filesystem::path& proofs,
                    const std::function<bool()>& stopped);

}  // namespace sinew::bridge

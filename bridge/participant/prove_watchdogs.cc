#include "bridge/participant/prove_watchdogs.h"

#include <spdlog/spdlog.h>

#include <iostream>
#include <memory>
#include <stdexcept>
#include <vector>

#include "bridge/joints/file/proof_file.h"
#include "components/base/types/clock/utc.h"
#include "components/robot/estop/estop_config.h"

namespace sinew::bridge {

std::filesystem::path ProofPath(const config::Section& section, const BridgeFile& file) {
  const bool hardware = file.bridge.live;
  const std::string text = file.watchdog_proof.value_or(hardware ? "default" : "none");
  if (text == "default") return estop::StateFolder() / "watchdog-proof.yaml";
  if (text == "none") {
    if (hardware) section.Fail("watchdog_proof", "is none, expected a path: this is hardware");
    return {};
  }
  const std::filesystem::path path(text);
  return path.is_absolute() ? path : section.file().parent_path() / path;
}

std::string ArmRefusal(const BridgeConfig& bridge, const std::filesystem::path& proofs,
                       const std::string& config_path) {
  if (proofs.empty()) return "";
  const std::string command = "sinew-can-bridge --config " + config_path + " --prove-watchdogs";
  try {
    return MissingProofs(bridge.joints, ReadProofs(proofs), command);
  } catch (const UsageError& error) {
    return std::string("the proofs of the watchdogs cannot be read: ") + error.what();
  }
}

void ProveWatchdogs(const BridgeFile& file, const std::filesystem::path& proofs,
                    const std::function<bool()>& stopped) {
  if (proofs.empty()) throw UsageError("--prove-watchdogs: the key watchdog_proof names no file");
  for (const JointConfig& joint : file.bridge.joints) {
    if (!joint.serial_number.empty()) continue;
    throw UsageError("joint '" + joint.name +
                     "': key serial_number is missing (odrivetool: " + "hex(odrv0.serial_number))");
  }
  std::vector<WatchdogProof> kept = ReadProofs(proofs);
  WriteProofs(proofs, kept);  // what cannot be kept is not tried
  // Everything on the buses is read: another sender of setpoints is found.
  std::vector<std::unique_ptr<can::Transport>> buses;
  for (const can::BusEntry& entry : file.buses) buses.push_back(can::OpenBus(entry, {}));

  std::string failed;
  for (const JointConfig& joint : file.bridge.joints) {
    if (stopped()) throw std::runtime_error("stopped; the axes are idle");
    can::Transport& bus = *buses[static_cast<std::size_t>(joint.bus)];
    can::Received old;
    while (bus.Receive(std::chrono::nanoseconds(0), &old)) {  // of the trials before
    }
    const WatchdogTrial trial = TryWatchdog(joint, file.bridge.timing, bus, stopped);
    if (trial.proven || trial.refuted) {  // else what was proven before still is
      std::erase_if(kept, [&](const WatchdogProof& proof) { return SameAxis(proof, joint); });
    }
    const std::string who = "joint '" + joint.name + "' (axis node " + std::to_string(joint.node) +
                            ", serial number " + joint.serial_number + "): ";
    if (trial.proven) {
      kept.push_back({joint.name, joint.serial_number, joint.node, joint.firmware,
                      trial.idle_after_ms, types::UtcNow()});
      std::cout << who << "its watchdog idles it within " << trial.idle_after_ms << " ms\n";
    } else {
      failed += (failed.empty() ? "" : "; ") + who + trial.why;
      std::cout << who << "NO PROOF: " << trial.why << '\n';
    }
    WriteProofs(proofs, kept);
  }
  if (!failed.empty()) throw std::runtime_error("no proof: " + failed);
  std::cout << "proofs are in " << proofs.string() << '\n';
}

}  // namespace sinew::bridge

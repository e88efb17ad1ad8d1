#include "bridge/joints/file/proof_file.h"

#include "bridge/can/file/bus_config.h"
#include "components/base/types/text.h"

namespace sinew::bridge {
static void Describe(config::Fields& f, WatchdogProof& c) {
  f.Need("joint", c.joint, "for people");
  f.Need("serial_number", c.serial_number, "of the controller, as in the joint map");
  f.Need("node", c.node, {0, can::kMaxNode},
         "of the axis: the axes of a controller share its serial number");
  can::DescribeFirmware(f, c.firmware);
  f.Need("idle_after_ms", c.idle_after_ms, config::kPositive,
         "the first heartbeat in idle, after the last setpoint; above 110 it counts for nothing");
  f.Need("made", c.made, "when");
}

void Describe(config::Fields& f, std::vector<WatchdogProof>& proofs) {
  f.List("proofs", {}, "one an axis",
         [&](config::Fields& proof) { Describe(proof, proofs.emplace_back()); });
}

std::vector<WatchdogProof> ReadProofs(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error) return {};
  const config::Section file = config::Section::Load(path, kProofSchema);
  config::Fields fields(file);
  std::vector<WatchdogProof> proofs;
  Describe(fields, proofs);
  file.RejectUnknownKeys();
  return proofs;
}

void WriteProofs(const std::filesystem::path& path, const std::vector<WatchdogProof>& proofs) {
  std::string text = std::string(
                         "# Axes whose own watchdog has idled them, by sinew-can-bridge "
                         "--prove-watchdogs.\nschema: ") +
                     kProofSchema + "\nproofs:" + (proofs.empty() ? " []" : "") + "\n";
  for (const WatchdogProof& proof : proofs) {
    text += "  - joint: \"" + proof.joint + "\"\n    serial_number: \"" + proof.serial_number +
            "\"\n    node: " + std::to_string(proof.node) +
            "\n    firmware: " + can::FirmwareName(proof.firmware) +
            "\n    idle_after_ms: " + types::Text("%.1f", proof.idle_after_ms) + "\n    made: \"" +
            proof.made + "\"\n";
  }
  config::WriteFileAtomically(path, text);
  config::SyncFolderOf(path);
}

}  // namespace sinew::bridge

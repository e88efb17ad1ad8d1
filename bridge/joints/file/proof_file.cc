#include "bridge/joints/file/proof_file.h"

#include <cstdio>

#include "bridge/can/file/bus_config.h"
#include "components/base/config/config.h"

namespace sinew::bridge {
namespace {

constexpr const char* kProofSchema = "sinew-watchdog-proof/1";

}  // namespace

std::vector<WatchdogProof> ReadProofs(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error) && !error) return {};
  const config::Section file = config::Section::Load(path, kProofSchema);
  std::vector<WatchdogProof> proofs;
  for (const config::Section& section : file.ListOrEmpty("proofs")) {
    WatchdogProof proof;
    proof.joint = section.Text("joint");
    proof.serial_number = section.Text("serial_number");
    proof.node = static_cast<int>(section.Integer("node", {0, can::kMaxNode}));
    proof.firmware = can::ReadFirmware(section);
    proof.idle_after_ms = section.Number("idle_after_ms", config::kPositive);
    proof.made = section.Text("made");
    section.RejectUnknownKeys();
    proofs.push_back(proof);
  }
  file.RejectUnknownKeys();
  return proofs;
}

void WriteProofs(const std::filesystem::path& path, const std::vector<WatchdogProof>& proofs) {
  std::string text = std::string(
                         "# Axes whose own watchdog has idled them, by sinew-can-bridge "
                         "--prove-watchdogs.\nschema: ") +
                     kProofSchema + "\nproofs:" + (proofs.empty() ? " []" : "") + "\n";
  for (const WatchdogProof& proof : proofs) {
    char number[32];
    std::snprintf(number, sizeof number, "%.1f", proof.idle_after_ms);
    text += "  - joint: \"" + proof.joint + "\"\n    serial_number: \"" + proof.serial_number +
            "\"\n    node: " + std::to_string(proof.node) +
            "\n    firmware: " + can::FirmwareName(proof.firmware) +
            "\n    idle_after_ms: " + number + "\n    made: \"" + proof.made + "\"\n";
  }
  config::WriteFileAtomically(path, text);
  config::SyncFolderOf(path);
}

}  // namespace sinew::bridge

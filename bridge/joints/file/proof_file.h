// The file of watchdog proofs, schema sinew-watchdog-proof/1. Not for loops.
#pragma once

#include <filesystem>
#include <vector>

#include "bridge/joints/watchdog_proof.h"
#include "components/base/config/fields.h"

namespace sinew::bridge {

inline constexpr char kProofSchema[] = "sinew-watchdog-proof/1";

void Describe(config::Fields& fields, std::vector<WatchdogProof>& proofs);

// Empty where there is no file. Throws UsageError: a file that cannot be read or understood.
std::vector<WatchdogProof> ReadProofs(const std::filesystem::path& path);

// As a whole or not at all, and on disk when this returns. Throws UsageError.
void WriteProofs(const std::filesystem::path& path, const std::vector<WatchdogProof>& proofs);

}  // namespace sinew::bridge

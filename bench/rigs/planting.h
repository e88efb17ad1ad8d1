// Effects of the size that a report gives as detectable: planted into fresh recordings of the
// same rig, other noise, they are to be found in 80 % of them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bench/rigs/files.h"

namespace sinew::rig_bank {

// The generator's effect for an entry of detectable.sizes (report.json). None: effects whose size
// here has another meaning (several parameters, lines of a spectrum, pushes), that the rig cannot
// have, or that are larger than plausible.
std::optional<rigs::Effect> PlantedEffect(const rigs::Rig& rig, const nlohmann::json& size);

struct Trial {
  std::string plain;  // case without an effect whose report printed the size
  rigs::Effect effect;
};
// `count` of them at most, from all plain cases that ended without a data fault: effects that
// were planted least come first, and each at most once in a case.
std::vector<Trial> DrawTrials(const std::filesystem::path& cases,
                              const std::filesystem::path& reports, int count);

// Case of kind `planted` for a trial.
CaseFiles MakePlanted(const rigs::Rig& rig, rigs::Excitation excitation, const Trial& trial);

// Makes all that are not there yet, and prints how many.
int PlantAll(const std::filesystem::path& cases, const std::filesystem::path& reports, int count,
             const std::filesystem::path& out);

}  // namespace sinew::rig_bank

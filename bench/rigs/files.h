// Files of a case: recordings, declared model, true values.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/rigs/drawn/cases.h"
#include "bench/rigs/drawn/sizing.h"

namespace sinew::rig_bank {

// An effect as it was made.
struct Made {
  rigs::Sizer::Sized sized;
  std::vector<std::string> same_class;
};

// All of a case, ready to be written.
struct CaseFiles {
  rigs::Case what;
  std::vector<Made> effects;
  std::vector<std::string> too_small;  // candidates that did not reach the share, left out
  rigs::Measured together;             // all effects at once
  std::vector<std::vector<rigs::Reading>> recordings;
  std::vector<rigs::FaultRows> fault_rows;
};

std::string CsvOf(const rigs::Rig& rig, const std::vector<rigs::Reading>& rows);
std::string MapOf(const rigs::Rig& rig);
std::string ModelOf(const rigs::Rig& rig, const std::string& fault);
nlohmann::json TruthOf(const rigs::Rig& rig, const CaseFiles& files);

// truth.json last, so that a folder without it is one that is not finished.
void WriteCase(const std::filesystem::path& folder, const rigs::Rig& rig, const CaseFiles& files);

// What the log holds of a run; fails where the simulation diverged (std::runtime_error).
std::vector<std::vector<rigs::Reading>> ReadRecordings(const rigs::Rig& rig, const rigs::Run& run,
                                                       const std::string& name);

// Makes one case; sizers are shared between the cases of a rig. noise_share: of the rig's noise in
// the recordings; sizes are those with all of it.
CaseFiles MakeCase(const rigs::Rig& rig, const rigs::Case& what, const rigs::Sizer& sizer,
                   double noise_share = 1.0);

}  // namespace sinew::rig_bank
